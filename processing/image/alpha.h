// SPDX-License-Identifier: GPL-3.0-or-later
// Transparency of PNG and EXR files. Everything else that reads pictures leaves it out.
//
// Alpha is 1 where a picture covers. Colours of a PNG are straight: as if it covered everywhere.
// Those of an EXR are associated: already multiplied by alpha, as both standards have it.
#pragma once

#include <cstddef>
#include <span>

#include "processing/image/image.h"
#include "processing/image/picture_file.h"

namespace patina {

// [h][w][1], of a PNG in [0,1], of an EXR as it is stored; empty where the file is another or has
// none. Throws ProcessingError(kBadData) for a damaged one.
Image<float> decodeAlpha(std::span<const std::byte> file, const PictureLimits& = {});

// [h][w][4]: sRGB, straight, and alpha.
Bytes encodeAlphaPng(ImageView<const std::uint8_t> srgb_alpha);
// [h][w][4]: linear, associated, and alpha, float32.
Bytes encodeAlphaExr(ImageView<const float> linear_alpha);

}  // namespace patina
