// SPDX-License-Identifier: GPL-3.0-or-later
// A picture as one number a texel.
#pragma once

#include <filesystem>

#include "processing/image/image.h"

namespace patina::workflow {

// [h][w][1] of `size`, the mean of the channels: of an EXR as it is, of others as displayed, 0
// black, 1 white. Resized by area. Throws as readPicture().
Image<float> greyPicture(const std::filesystem::path& file, SizePx size);
// Of the picture's own size.
Image<float> greyPicture(const std::filesystem::path& file);

}  // namespace patina::workflow
