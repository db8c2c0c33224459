// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/keogram.h"

#include <algorithm>
#include <cmath>

#include "processing/image/encoding.h"
#include "processing/image/warp.h"
#include "processing/render/axis.h"
#include "processing/render/canvas.h"
#include "processing/render/font.h"
#include "processing/render/palette.h"

namespace patina::render {
namespace {

void check(const std::vector<KeogramLine>& lines, const KeogramOptions& options) {
  const auto refuse = [](const char* why) { throw ProcessingError(Exit::kUsage, why); };
  if (lines.empty()) refuse("a keogram needs at least one frame");
  if (options.plot.width < 100 || options.plot.width > 20000 || options.plot.height < 0 ||
      options.plot.height > 20000)
    refuse("a keogram is 100 to 20000 pixels wide and at most 20000 high");
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (lines[i].column.width() != 1 || lines[i].column.channels() != 3 ||
        lines[i].column.height() != lines[0].column.height())
      refuse("keogram: the frames differ in height");
    if (!std::isfinite(lines[i].time_s) || (i > 0 && lines[i].time_s < lines[i - 1].time_s))
      refuse("keogram: the frames are not in the order of time");
  }
}

double hold(const std::vector<KeogramLine>& lines, const KeogramOptions& options) {
  if (options.interval_s > 0) return options.interval_s;
  std::vector<double> steps;
  for (std::size_t i = 1; i < lines.size(); ++i)
    steps.push_back(lines[i].time_s - lines[i - 1].time_s);
  if (steps.empty()) return 1;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return std::max(*middle * 1.5, 1e-9);
}

// Which lines show in the pixel column [from, to): those that begin in it, else the one that still
// holds. Empty: a gap.
std::pair<std::size_t, std::size_t> linesWithin(const std::vector<KeogramLine>& lines, double from,
                                                double to, double hold_s) {
  const auto after = [&](double t) {
    return static_cast<std::size_t>(
        std::lower_bound(lines.begin(), lines.end(), t,
                         [](const KeogramLine& l, double v) { return l.time_s < v; }) -
        lines.begin());
  };
  const std::size_t begin = after(from), end = after(to);
  if (begin < end) return {begin, end};
  if (begin > 0 && from < lines[begin - 1].time_s + hold_s) return {begin - 1, begin};
  return {0, 0};
}

void drawFrame(Canvas& canvas, RectPx plot, double begin, double end, int height,
               const KeogramOptions& options) {
  const double x0 = plot.x - 0.5, x1 = plot.x + plot.width + 0.5;
  const double y0 = plot.y - 0.5, y1 = plot.y + plot.height + 0.5;
  canvas.line({{x0, y0}, {x1, y0}, {x1, y1}, {x0, y1}, {x0, y0}}, 1, kAxis);
  for (const Tick& t : ticksOf(begin, end, std::max(2, plot.width / 120), AxisKind::kElapsed)) {
    const double x = std::round(plot.x + (t.value - begin) / (end - begin) * plot.width) + 0.5;
    canvas.line({{x, y1}, {x, y1 + (t.label.empty() ? 3 : 6)}}, 1, kAxis);
    canvas.text({x, y1 + 21}, t.label, {.size_px = 13, .colour = kInk, .align = Align::kMiddle});
  }
  for (const Tick& t : ticksOf(0, height, std::max(2, plot.height / 70), AxisKind::kNumber)) {
    if (t.label.empty()) continue;
    const double y = std::round(plot.y + t.value / height * plot.height) + 0.5;
    canvas.line({{x0 - 5, y}, {x0, y}}, 1, kAxis);
    canvas.text({x0 - 9, y + 4.5}, t.label,
                {.size_px = 13, .colour = kInk, .align = Align::kRight});
  }
  canvas.text({20, plot.y + plot.height / 2.0}, options.y_label,
              {.size_px = 13, .colour = kFaintInk, .align = Align::kMiddle, .upwards = true});
  if (!options.title.empty())
    canvas.text({static_cast<double>(plot.x), 27}, options.title, {.size_px = 17, .colour = kInk});
}

void drawGapLegend(Canvas& canvas, RectPx plot) {
  const int x = plot.x + plot.width - static_cast<int>(textWidth("no frame", 13)) - 30;
  canvas.hatch({x, 14, 20, 14}, kMissingGround, kMissingStripe);
  canvas.text({x + 28.0, 26}, "no frame", {.size_px = 13, .colour = kInk});
}

}  // namespace

Image<std::uint8_t> keogramColumn(ImageView<const std::uint8_t> srgb, int x, int width_px) {
  PATINA_CHECK(!srgb.empty() && width_px >= 1);
  const int width = std::min(width_px, srgb.width);
  const int first = std::clamp(x - width / 2, 0, srgb.width - width);
  const auto mean =
      resizeArea(decodeSrgb(srgb.crop({first, 0, width, srgb.height})).view(), {1, srgb.height});
  auto one = encodeSrgb8(mean.view());
  if (one.channels() == 3) return one;
  Image<std::uint8_t> out(1, srgb.height, 3);
  for (int y = 0; y < srgb.height; ++y)
    for (int c = 0; c < 3; ++c) out.at(0, y, c) = one.at(0, y, 0);
  return out;
}

Image<std::uint8_t> drawKeogram(const std::vector<KeogramLine>& lines,
                                const KeogramOptions& options) {
  check(lines, options);
  const int source_height = lines[0].column.height();
  const double hold_s = hold(lines, options);
  double begin = options.begin_s, end = options.end_s;
  if (!(end > begin)) {
    begin = lines.front().time_s;
    end = lines.back().time_s + (lines.size() > 1 ? hold_s / 1.5 : hold_s);
  }
  const int height =
      options.plot.height > 0 ? options.plot.height : std::clamp(source_height, 160, 600);
  const RectPx plot{74, 42, options.plot.width, height};
  Canvas canvas({plot.x + plot.width + 28, plot.y + plot.height + 34}, kWhite);
  canvas.hatch(plot, kMissingGround, kMissingStripe);
  bool gaps = false;
  Image<float> sum;
  for (int x = 0; x < plot.width; ++x) {
    const double per_pixel = (end - begin) / plot.width;
    const auto [first, last] =
        linesWithin(lines, begin + x * per_pixel, begin + (x + 1) * per_pixel, hold_s);
    gaps = gaps || first == last;
    if (first == last) continue;
    sum = Image<float>(1, source_height, 3);
    for (std::size_t i = first; i < last; ++i) {
      const auto linear = decodeSrgb(lines[i].column.view());
      for (std::size_t k = 0; k < sum.texels().size(); ++k)
        sum.texels()[k] += linear.texels()[k] / static_cast<float>(last - first);
    }
    canvas.picture(plot.x + x, plot.y,
                   encodeSrgb8(resizeArea(sum.view(), {1, height}).view()).view());
  }
  drawFrame(canvas, plot, begin, end, source_height, options);
  if (gaps) drawGapLegend(canvas, plot);
  return canvas.take();
}

}  // namespace patina::render
