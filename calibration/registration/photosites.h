// SPDX-License-Identifier: GPL-3.0-or-later
// What a mosaic's own pixels saw, taken out of a picture whose colours were interpolated from it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "processing/image/image.h"

namespace patina::calibration {

// Of the 2x2 cell, row by row.
inline std::size_t placeInCell(int x, int y) {
  return static_cast<std::size_t>(y & 1) * 2 + static_cast<std::size_t>(x & 1);
}

struct Photosites {
  Image<float> samples;               // [h][w], each of its own colour; empty: no mosaic shows
  std::array<std::uint8_t, 4> cfa{};  // of the 2x2 cell, row by row; 0 R, 1 G, 2 B

  bool empty() const { return samples.empty(); }
  int colourAt(int x, int y) const { return cfa[placeInCell(x, y)]; }
};

// A colour's own pixels vary more from neighbour to neighbour than what was interpolated between
// them (Gallagher and Chen, "Image authentication by detecting traces of demosaicing", 2008): which
// of the four Bayer cells that fits, if any does. Of bilinear interpolation (demosaicLinear) alone;
// a picture that was resampled or smoothed since, or has one channel, has none. O(pixels),
// multi-threaded; the same for any number of threads.
Photosites photositesOf(ImageView<const float> linear);

}  // namespace patina::calibration
