// SPDX-License-Identifier: GPL-3.0-or-later
// Resampling. Values are mixed as they are, so give linear light; resizeSrgb does that for you.
#pragma once

#include <array>
#include <cstdint>

#include "processing/image/image.h"

namespace patina {

// Mean of the covered area where it shrinks, bilinear where it grows, each axis by itself. Keeps
// the mean exactly when shrinking by a whole number. O(texels in + texels out), multi-threaded.
Image<float> resizeArea(ImageView<const float> in, SizePx size);
// The same for pictures, through linear light.
Image<std::uint8_t> resizeSrgb(ImageView<const std::uint8_t> srgb, SizePx size);

// The largest size of the same shape inside `box`, at least 1x1.
SizePx fitInside(SizePx picture, SizePx box);

// out(x, y) = in at source_from_target (x, y, 1), a 3x3 matrix by rows over pixel centres at whole
// numbers, bilinear. `outside` where the source has no texel.
Image<float> warpBilinear(ImageView<const float> in,
                          const std::array<double, 9>& source_from_target, SizePx size,
                          float outside = 0);

}  // namespace patina
