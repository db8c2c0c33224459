// SPDX-License-Identifier: GPL-3.0-or-later
// Packed samples as files keep them. Pure; throws what unpackSamples() throws.
#pragma once

#include <array>
#include <cstdint>

#include "processing/image/dng_file.h"
#include "processing/image/packed_pixels.h"

namespace patina {

// Grey over the full scale of 16 bits: v * 65535 / white, rounded; no two become one.
Image<std::uint16_t> unpackFullScale(const PackedPixels& packed);
// A Bayer mosaic whose white level is that of its bits. What else is known of it is the caller's.
RawMosaic unpackMosaic(const PackedPixels& packed, const std::array<std::uint8_t, 4>& cfa,
                       double black_level);

}  // namespace patina
