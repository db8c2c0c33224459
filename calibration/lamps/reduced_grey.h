// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/image.h"

namespace patina::calibration {

// Means over the channels of blocks of `by` x `by` texels; a rest at the right and lower edge is
// left out. O(texels), rows in parallel.
Image<float> reducedGrey(ImageView<const float> picture, int by);
// The `by` that leaves the longer side at most `side_px`.
int reductionTo(int side_px, SizePx of);

}  // namespace patina::calibration
