// SPDX-License-Identifier: GPL-3.0-or-later
// Can a seam be seen? Compares gradients across seams with gradients inside copied pieces.
#pragma once

#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

// A seam lies between two neighbours of the result whose sources are no neighbours, or are shown
// at times of their own. `result`
// [h][w][c] has the size of the quilt. Mean Euclidean difference over seam pairs, over that of all
// other pairs: 1 is what the material itself does; 0 where there is no seam. O(texels).
double seamRatio(ImageView<const float> result, const Quilt& quilt);

}  // namespace patina::quilting
