// SPDX-License-Identifier: GPL-3.0-or-later
// Small pictures for people to look at.
#pragma once

#include "processing/image/picture_file.h"

namespace patina {

constexpr int kThumbnailPx = 256;  // of those that are made of every frame

// A JPEG whose longer side is `side_px`, or the picture's own where that is smaller. O(texels).
Bytes thumbnailJpeg(const Picture& picture, int side_px);

}  // namespace patina
