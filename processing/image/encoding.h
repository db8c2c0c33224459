// SPDX-License-Identifier: GPL-3.0-or-later
// Linear light to display values and back: IEC 61966-2-1 (sRGB). Values in [0,1]; clamped.
#pragma once

#include <cstdint>

#include "processing/image/image.h"

namespace patina {

float srgbFromLinear(float linear);
float linearFromSrgb(float encoded);

std::uint8_t encodeSrgb8(float linear);  // of one sample

// Tables make these cheap: O(texels), multi-threaded, 8 bits a channel.
Image<std::uint8_t> encodeSrgb8(ImageView<const float> linear);          // [h][w][c]
Image<std::uint8_t> encodeSrgb8(ImageView<const std::uint16_t> linear);  // 65535 = 1.0
Image<float> decodeSrgb(ImageView<const std::uint8_t> encoded);          // to linear [0,1]
Image<float> decodeSrgb(ImageView<const std::uint16_t> encoded);
Image<std::uint16_t> quantize16(ImageView<const float> linear);  // 1.0 -> 65535, rounds, clamps

}  // namespace patina
