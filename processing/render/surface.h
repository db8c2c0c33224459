// SPDX-License-Identifier: GPL-3.0-or-later
// What charts are drawn on: pixels (canvas.h) or SVG (svg.h).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace patina::render {

// Display-encoded sRGB; alpha in [0,1].
struct Colour {
  std::uint8_t r = 0, g = 0, b = 0;
  double alpha = 1;
};

// Pixels, x right, y down, (0, 0) the outer corner of the first pixel.
struct Point {
  double x = 0, y = 0;
};

enum class Align { kLeft, kMiddle, kRight };
struct TextStyle {
  double size_px = 13;
  Colour colour{40, 40, 40};
  Align align = Align::kLeft;
  bool upwards = false;  // turned a quarter to the left
};

class Surface {
 public:
  virtual ~Surface() = default;
  virtual void polygon(const std::vector<Point>& corners, Colour colour) = 0;
  // `dash_px` 0: solid.
  virtual void line(const std::vector<Point>& points, double width_px, Colour colour,
                    double dash_px = 0) = 0;
  virtual void disc(Point centre, double radius_px, Colour colour) = 0;
  // `at` is on the baseline.
  virtual void text(Point at, std::string_view text, const TextStyle& style) = 0;

  void box(Point a, Point b, Colour colour) { polygon({a, {b.x, a.y}, b, {a.x, b.y}}, colour); }
};

}  // namespace patina::render
