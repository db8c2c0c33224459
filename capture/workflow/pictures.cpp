// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/pictures.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <utility>

#include "capture/workflow/failure.h"
#include "processing/render/axis.h"
#include "processing/render/chart.h"
#include "processing/render/contact_sheet.h"
#include "processing/render/keogram.h"
#include "processing/render/palette.h"
#include "processing/render/plate.h"

namespace patina::workflow {
namespace {

// Means of whole squares of texels, so that a sheet of large pictures fits in memory.
Image<float> shrunk(Image<float> image, int side_px) {
  const int factor = std::min(image.width(), image.height()) / side_px;
  if (factor < 2) return image;
  Image<float> small(image.width() / factor, image.height() / factor, image.channels());
  const float share = 1.0f / static_cast<float>(factor * factor);
  for (int y = 0; y < small.height(); ++y)
    for (int x = 0; x < small.width(); ++x)
      for (int c = 0; c < small.channels(); ++c) {
        float sum = 0;
        for (int dy = 0; dy < factor; ++dy)
          for (int dx = 0; dx < factor; ++dx) sum += image.at(x * factor + dx, y * factor + dy, c);
        small.at(x, y, c) = sum * share;
      }
  return small;
}

struct Shown {
  double time_s = 0;
  Image<std::uint8_t> picture;
};

// The frames of these indices (rising), as displayed.
std::vector<Shown> showFrames(const Sequence& sequence, const std::vector<std::int64_t>& indices,
                              RectPx region, double gain, int side_px, Progress& progress) {
  // A stride that all indices share lets the source leave out what is not wanted.
  std::int64_t stride = 0;
  for (const std::int64_t index : indices) stride = std::gcd(stride, index);
  stride = std::max<std::int64_t>(stride, 1);
  const auto source = sequence.open(static_cast<int>(stride));
  std::vector<Shown> shown;
  auto wanted = indices.begin();
  for (std::int64_t at = 0; wanted != indices.end(); at += stride) {
    auto frame = source->next();
    if (!frame) break;
    progress.step();
    if (at != *wanted) continue;
    Image<float>& whole = frame->linear;
    const bool part = region.width < whole.width() || region.height < whole.height();
    const Image<float> linear =
        shrunk(part ? copyOf(std::as_const(whole).view().crop(region)) : std::move(whole), side_px);
    shown.push_back({frame->time_s, toDisplay(linear.view(), gain)});
    ++wanted;
  }
  if (shown.empty()) throw WorkflowError(Exit::kBadData, sequence.name + " has no frames");
  return shown;
}

RectPx wholeOf(const Sequence& sequence) {
  return {0, 0, sequence.size.width, sequence.size.height};
}

RectPx regionOf(const Sequence& sequence, const SheetRequest& request) {
  if (!request.region) return wholeOf(sequence);
  const RectPx& r = *request.region;
  if (r.x < 0 || r.y < 0 || r.width < 1 || r.height < 1 || r.x > sequence.size.width - r.width ||
      r.y > sequence.size.height - r.height)
    throw WorkflowError(Exit::kUsage, "the region is not within the frames of " +
                                          std::to_string(sequence.size.width) + "x" +
                                          std::to_string(sequence.size.height));
  return r;
}

}  // namespace

std::vector<std::int64_t> spreadEvenly(std::int64_t frames, std::int64_t wanted) {
  std::vector<std::int64_t> indices;
  const std::int64_t count = std::min(frames, wanted);
  // A stride that is the same throughout, where there is one: a sheet is then quick to make.
  if (count > 2 && frames > 2 * count) {
    const std::int64_t stride = (frames - 1) / (count - 1);
    for (std::int64_t i = 0; i < count; ++i) indices.push_back(i * stride);
    return indices;
  }
  for (std::int64_t i = 0; i < count; ++i)
    indices.push_back(count == 1 ? 0 : (i * (frames - 1) + (count - 1) / 2) / (count - 1));
  return indices;
}

Image<std::uint8_t> makeSheet(const Sequence& sequence, const SheetRequest& request,
                              Progress& progress) {
  const RectPx region = regionOf(sequence, request);
  const double gain = gainOf(sequence, request.show, progress);
  const auto indices = spreadEvenly(sequence.frames, request.cells);
  progress.begin("making the sheet", static_cast<std::int64_t>(indices.size()));
  std::vector<Shown> shown =
      showFrames(sequence, indices, region, gain, request.cell_width_px, progress);
  const double span = shown.back().time_s - shown.front().time_s;
  std::vector<render::SheetCell> cells;
  for (Shown& one : shown)
    cells.push_back({std::move(one.picture), render::elapsedLabel(one.time_s, span), {}});
  render::SheetOptions options;
  options.title = sequence.name;
  options.columns = request.columns;
  options.cell_width_px = request.cell_width_px;
  return render::drawContactSheet(cells, options);
}

Image<std::uint8_t> makeKeogram(const Sequence& sequence, const KeogramRequest& request,
                                Progress& progress) {
  const double gain = gainOf(sequence, request.show, progress);
  const int x = request.column >= 0 ? request.column : sequence.size.width / 2;
  if (x >= sequence.size.width)
    throw WorkflowError(Exit::kUsage, "column " + std::to_string(x) + " is beyond the pictures' " +
                                          std::to_string(sequence.size.width) + " pixels");
  const auto source = sequence.open(1);
  progress.begin("making the keogram", source->count());
  std::vector<render::KeogramLine> lines;
  const int from = std::max(0, x - request.width_px),
            to = std::min(sequence.size.width, x + request.width_px + 1);
  while (const auto frame = source->next()) {
    const auto strip = frame->linear.view().crop({from, 0, to - from, frame->linear.height()});
    const Image<std::uint8_t> shown = toDisplay(strip, gain);
    lines.push_back(
        {frame->time_s, render::keogramColumn(shown.view(), x - from, request.width_px)});
    progress.step();
  }
  render::KeogramOptions options;
  options.title = sequence.name + ", column " + std::to_string(x);
  return render::drawKeogram(lines, options);
}

Image<std::uint8_t> makePlate(const std::vector<PlateSubject>& subjects, int columns, int cell_px,
                              Progress& progress) {
  std::vector<render::PlateRow> rows;
  progress.begin("making the plate", static_cast<std::int64_t>(subjects.size()) * columns);
  for (const PlateSubject& subject : subjects) {
    Progress silent;
    const double gain = displayGain(subject.sequence, silent);
    std::vector<Shown> shown =
        showFrames(subject.sequence, spreadEvenly(subject.sequence.frames, columns),
                   wholeOf(subject.sequence), gain, cell_px, progress);
    const double span = shown.back().time_s - shown.front().time_s;
    render::PlateRow row{subject.name, subject.detail, {}, {}};
    for (Shown& one : shown) {
      row.labels.push_back(render::elapsedLabel(one.time_s, span));
      row.pictures.push_back(std::move(one.picture));
    }
    rows.push_back(std::move(row));
  }
  render::PlateOptions options;
  options.cell_px = cell_px;
  return render::drawPlate(rows, options);
}

Image<std::uint8_t> drawLight(const LightReport& report) {
  render::Chart chart;
  chart.title = "Light of " + report.run_id;
  chart.x_label = "time since the start";
  chart.y_label = "level / baseline";
  chart.x_kind = render::AxisKind::kElapsed;
  for (const BadSpell& spell : report.spells) {
    render::Colour colour = render::meaningColour(spell.verdict);
    colour.alpha = 0.18;
    chart.spans.push_back(
        {{}, colour, toSeconds(spell.from - report.t0_utc), toSeconds(spell.to - report.t0_utc)});
  }
  std::set<std::string> lights;
  for (const LightSeriesReport& series : report.series) lights.insert(series.light);
  std::map<std::string, render::ChartPoints> bad;
  for (const LightSeriesReport& series : report.series) {
    if (!isLevel(series)) continue;
    const auto index = std::distance(lights.begin(), lights.find(series.light));
    render::ChartLine line;
    line.name = series.light;
    line.colour = render::seriesColour(static_cast<int>(index));
    line.colour.alpha = 0.8;
    line.width_px = 1.2;
    for (std::size_t i = 0; i < series.ratio.size(); ++i) {
      line.x.push_back(series.time_s[i]);
      line.y.push_back(series.ratio[i]);
      if (isGoodVerdict(series.verdict[i])) continue;
      render::ChartPoints& points = bad[series.verdict[i]];
      points.name = series.verdict[i];
      points.colour = render::meaningColour(series.verdict[i]);
      points.size_px = 5;
      points.x.push_back(series.time_s[i]);
      points.y.push_back(series.ratio[i]);
    }
    chart.lines.push_back(std::move(line));
  }
  for (auto& [verdict, points] : bad) chart.points.push_back(std::move(points));
  return render::drawChart(chart);
}

}  // namespace patina::workflow
