// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/colour_picture.h"

#include <algorithm>
#include <cstdio>

#include "processing/image/encoding.h"
#include "processing/render/canvas.h"

namespace patina::workflow {
namespace {

using calibration::kChartColumns;
using calibration::kChartFields;
using calibration::kChartRows;

constexpr int kCell = 150, kGap = 12, kField = 108, kMargin = 16, kHead = 56;
constexpr int kMiddle = 36;  // side of what is expected
constexpr render::Colour kInk{225, 225, 225}, kFaint{150, 150, 150}, kGround{38, 38, 38};

render::Colour shown(const calibration::Lab& lab) {
  const calibration::Xyz xyz = calibration::xyzOf(lab);
  const auto rgb = calibration::mapped(calibration::linearSrgbFromXyz(), {xyz.x, xyz.y, xyz.z});
  const auto encoded = [](double v) {
    return encodeSrgb8(static_cast<float>(std::clamp(v, 0.0, 1.0)));
  };
  return {encoded(rgb[0]), encoded(rgb[1]), encoded(rgb[2])};
}

std::string fixed(const char* format, double value) {
  char text[64];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

void drawField(render::Canvas& canvas, int field, const calibration::FieldColours& colours) {
  const double x = kMargin + (field % kChartColumns) * (kCell + kGap),
               y = kHead + (field / kChartColumns) * (kField + 44), middle = x + kCell / 2.0,
               centre = y + kField / 2.0;
  canvas.box({x, y}, {middle, y + kField}, shown(colours.before));
  canvas.box({middle, y}, {x + kCell, y + kField}, shown(colours.after));
  canvas.box({middle - kMiddle / 2.0, centre - kMiddle / 2.0},
             {middle + kMiddle / 2.0, centre + kMiddle / 2.0}, shown(colours.expected));
  canvas.text({x, y + kField + 15}, calibration::fieldName(field),
              {.size_px = 12, .colour = kFaint});
  canvas.text({x, y + kField + 31}, fixed("%.1f", colours.delta_e_before),
              {.size_px = 13, .colour = kInk});
  canvas.text({x + kCell, y + kField + 31}, fixed("%.2f", colours.delta_e_after),
              {.size_px = 13, .colour = kInk, .align = render::Align::kRight});
}

}  // namespace

Image<std::uint8_t> drawColours(const ColourCalibration& calibration) {
  const SizePx size{2 * kMargin + kChartColumns * (kCell + kGap) - kGap,
                    kHead + kChartRows * (kField + 44) + 8};
  render::Canvas canvas(size, kGround);
  const calibration::ColourFitReport& report = calibration.report;
  std::string title = calibration.camera.empty() ? "Colours" : "Colours of " + calibration.camera;
  if (!calibration.light.empty()) title += " under " + calibration.light;
  title += ", fit " + nameOf(calibration.model.kind);
  canvas.text({kMargin, 22}, title, {.size_px = 16, .colour = kInk});
  canvas.text({kMargin, 42},
              fixed("before (left): mean deltaE 2000 %.2f", report.mean_before) +
                  fixed("; after (right): %.2f", report.mean_after) +
                  "; in the middle what the field is",
              {.size_px = 13, .colour = kFaint});
  for (int i = 0; i < kChartFields; ++i) drawField(canvas, i, report.fields[i]);
  return canvas.take();
}

}  // namespace patina::workflow
