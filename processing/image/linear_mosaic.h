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

// The same with the detail that the other colours have there (Malvar, He and Cutler 2004, linear,
// 5x5): sharper where colours change together. Other mosaics than Bayer's, and the outer two rows
// and columns, as above.
Image<float> demosaicDetailed(ImageView<const float> mosaic,
                              const std::array<std::uint8_t, 4>& cfa);

}  // namespace patina
