// SPDX-License-Identifier: GPL-3.0-or-later
// Where each texel of a result is seen in a source picture. Maps compose, so that geometry of
// several causes (lens, view, registration) is resampled once.
#pragma once

#include <array>

#include "processing/image/image.h"

namespace patina {

// Values only: copy, compare and compose freely.
struct PixelMap {
  Image<float>
      source_px;  // [h][w][2]: x, y in the source; pixel centres at whole numbers; NaN: unseen

  SizePx size() const { return source_px.size(); }  // of the result, in texels
};

// Texel (x, y) is the pixel (x, y) of `region`: a crop.
PixelMap identityMap(RectPx region);

// A map into one picture becomes a map into the next one. The step between the pictures is a 3x3
// matrix by rows (a motion found by registration, `next_from_source`), or a map of the size of the
// first picture, which is interpolated bilinearly. What lies outside of that is unseen. O(texels).
PixelMap composed(const PixelMap& map, const std::array<double, 9>& next_from_source);
PixelMap composed(const PixelMap& map, const PixelMap& next_from_source);

// Mean distance between neighbouring texels' places, in source pixels: above 1 the result is
// coarser than the source. NaN when no two neighbours are seen.
double meanStep(const PixelMap& map);

// The result: Keys' cubic (a = -1/2), widened to what a texel covers along each axis of the source
// wherever that is more than a pixel, so that fine detail is averaged, not aliased. Reproduces
// constants everywhere, and whole-pixel shifts exactly. Edge pixels are repeated beyond the edge;
// texels whose place is not within the source are `outside`. Give linear light. Overshoots at
// edges by up to 7 % of the step. O(texels x 16 x pixels a texel covers), multi-threaded; the same
// result for any number of threads.
// R. G. Keys, "Cubic convolution interpolation for digital image processing", 1981, equation 15.
Image<float> resample(ImageView<const float> in, const PixelMap& map, float outside = 0);

}  // namespace patina
