// SPDX-License-Identifier: GPL-3.0-or-later
// A chart of lines and points: the light over a week, a fit's error, temperature against time.
// Values in, picture or SVG out; both by the same code.
#pragma once

#include <limits>
#include <optional>

#include "processing/image/image.h"
#include "processing/render/axis.h"
#include "processing/render/surface.h"

namespace patina::render {

struct ChartLine {
  std::string name{};  // for the legend; equal names share an entry, empty ones have none
  Colour colour{};
  std::vector<double> x{}, y{};  // a NaN breaks the line
  double width_px = 1.8;
  bool dashed = false;
};
enum class Marker { kDisc, kRing, kSquare, kCross };
struct ChartPoints {
  std::string name{};
  Colour colour{};
  std::vector<double> x{}, y{};
  Marker marker = Marker::kDisc;
  double size_px = 6;
};
struct ChartSpan {  // an interval of x over the whole height: nobody was running, the light was bad
  std::string name{};
  Colour colour{};
  double from = 0, to = 0;
};
struct ChartBand {  // an interval of y over the whole width: what is tolerated
  std::string name{};
  Colour colour{};
  double low = 0, high = 0;
};

struct Chart {
  std::string title, x_label, y_label;
  AxisKind x_kind = AxisKind::kNumber;
  std::vector<ChartSpan> spans;  // drawn in this order: spans, bands, lines, points
  std::vector<ChartBand> bands;
  std::vector<ChartLine> lines;
  std::vector<ChartPoints> points;
  // Nothing: from the values, with a margin. Values above or below a fixed end stand at the edge.
  std::optional<double> x_low, x_high, y_low, y_high;
  SizePx size{1200, 500};
};

// O(values). An axis without any finite value says "no data". Throws ProcessingError(kUsage) below
// 240x160 pixels or where x and y differ in length.
Image<std::uint8_t> drawChart(const Chart& chart);
std::string chartSvg(const Chart& chart);

}  // namespace patina::render
