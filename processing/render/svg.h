// SPDX-License-Identifier: GPL-3.0-or-later
// A surface whose result is SVG text, for pages.
#pragma once

#include "processing/image/units.h"
#include "processing/render/surface.h"

namespace patina::render {

class SvgSurface final : public Surface {
 public:
  explicit SvgSurface(SizePx size) : size_(size) {}

  void polygon(const std::vector<Point>& corners, Colour colour) override;
  void line(const std::vector<Point>& points, double width_px, Colour colour,
            double dash_px = 0) override;
  void disc(Point centre, double radius_px, Colour colour) override;
  void text(Point at, std::string_view text, const TextStyle& style) override;

  std::string finish() const;  // one <svg> element on a white ground

 private:
  SizePx size_;
  std::string body_;
};

}  // namespace patina::render
