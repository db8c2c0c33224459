// SPDX-License-Identifier: GPL-3.0-or-later
// Transparency of PNG files. Everything else that reads pictures leaves it out.
#pragma once

#include <cstddef>
#include <span>

#include "processing/image/image.h"
#include "processing/image/picture_file.h"

namespace patina {

// Straight alpha in [0,1], [h][w][1]; empty where the file is no PNG or has none. Throws
// ProcessingError(kBadData) for a damaged PNG.
Image<float> decodeAlpha(std::span<const std::byte> file, const PictureLimits& = {});

// [h][w][4]: sRGB and straight alpha.
Bytes encodeAlphaPng(ImageView<const std::uint8_t> srgb_alpha);

}  // namespace patina
