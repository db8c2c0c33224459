// SPDX-License-Identifier: GPL-3.0-or-later
// What a test asks of a drawn picture.
#pragma once

#include <cstdlib>

#include "processing/image/image.h"
#include "processing/render/surface.h"

namespace patina::render {

inline bool isNear(const Image<std::uint8_t>& image, int x, int y, Colour colour, int slack = 6) {
  return std::abs(image.at(x, y, 0) - colour.r) <= slack &&
         std::abs(image.at(x, y, 1) - colour.g) <= slack &&
         std::abs(image.at(x, y, 2) - colour.b) <= slack;
}

inline int countNear(const Image<std::uint8_t>& image, Colour colour, int slack = 6) {
  int n = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) n += isNear(image, x, y, colour, slack) ? 1 : 0;
  return n;
}

// Sum of what is not white, in whole pixels of black.
inline double inkIn(const Image<std::uint8_t>& image) {
  double ink = 0;
  for (std::uint8_t v : image.texels()) ink += (255 - v) / (3 * 255.0);
  return ink;
}

}  // namespace patina::render
