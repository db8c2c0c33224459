// SPDX-License-Identifier: GPL-3.0-or-later
// Pixels to draw on, antialiased by exact coverage. Same bytes on every machine.
#pragma once

#include <span>

#include "processing/image/image.h"
#include "processing/render/surface.h"

namespace patina::render {

class Canvas final : public Surface {
 public:
  Canvas(SizePx size, Colour background);

  void polygon(const std::vector<Point>& corners, Colour colour) override;
  void line(const std::vector<Point>& points, double width_px, Colour colour,
            double dash_px = 0) override;
  void disc(Point centre, double radius_px, Colour colour) override;
  void text(Point at, std::string_view text, const TextStyle& style) override;

  // Copied with its upper left corner at (x, y), clipped; [h][w][1 or 3] sRGB.
  void picture(int x, int y, ImageView<const std::uint8_t> srgb);
  // Diagonal stripes: nothing was here.
  void hatch(RectPx rect, Colour ground, Colour stripe);

  const Image<std::uint8_t>& image() const { return image_; }
  Image<std::uint8_t> take() { return std::move(image_); }

 private:
  void fill(std::span<const std::vector<Point>> contours, Colour colour);
  void blend(int x, int y, Colour colour, double coverage);

  Image<std::uint8_t> image_;
};

}  // namespace patina::render
