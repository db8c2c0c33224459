// SPDX-License-Identifier: GPL-3.0-or-later
// A chart as it was seen, as it comes out and as it is, for a person to look at.
#pragma once

#include "capture/workflow/colour_calibration.h"
#include "processing/image/image.h"

namespace patina::workflow {

// [h][w][3] sRGB: every field before (left) and after (right) its calibration, with what it is in
// the middle, and deltaE 2000 of both. What sRGB does not hold is clipped.
Image<std::uint8_t> drawColours(const ColourCalibration& calibration);

}  // namespace patina::workflow
