// SPDX-License-Identifier: GPL-3.0-or-later
// What in a picture is not the specimen: rectangles a person names, and markers found by
// themselves.
#pragma once

#include <span>
#include <vector>

#include "processing/image/image.h"

namespace patina::calibration {

// ArUco markers of the dictionary 4x4_50, each with half of its side around it: the quiet zone and
// what it lies on. [h][w], 255 within. Throws CalibrationError(kBadData) when fewer than two are
// found: one alone says little about a turn. O(pixels).
Image<std::uint8_t> markersIn(ImageView<const float> linear);
int countMarkers(ImageView<const float> linear);

// 255 within any of the rectangles. Throws CalibrationError(kUsage) for one that does not lie in
// the picture.
Image<std::uint8_t> maskOf(std::span<const RectPx> rectangles, SizePx size);

}  // namespace patina::calibration
