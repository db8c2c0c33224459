// SPDX-License-Identifier: GPL-3.0-or-later
// Three colours of a mosaic that is in linear light already: a corrected raw frame.
#pragma once

#include <array>
#include <cstdint>

#include "processing/image/image.h"

namespace patina {

// The same bilinear interpolation as demosaic(RawMosaic) in dng_file.h, of [h][w][1] to [h][w][3].
// `cfa` as there. O(pixels), multi-threaded.
Image<float> demosaicLinear(ImageView<const float> mosaic, const std::array<std::uint8_t, 4>& cfa);

}  // namespace patina
