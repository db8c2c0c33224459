// SPDX-License-Identifier: GPL-3.0-or-later
// Can a seam be seen? Compares gradients across seams with gradients inside copied pieces.
#pragma once

#include <span>

#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

// A seam lies between two neighbours of the result whose sources are no neighbours, or are shown
// at times of their own. `result`
// [h][w][c] has the size of the quilt. Mean Euclidean difference over seam pairs, over that of all
// other pairs: 1 is what the material itself does; 0 where there is no seam. O(texels).
double seamRatio(ImageView<const float> result, const Quilt& quilt);

// The same gradient over what lies there in the sources: at each seam, the mean of the gradients
// that the sources of its two sides show across that very edge (of one side where the other's ends
// there). Whether a seam is steeper than its place, wherever the cut ran. `sources`: the frame that
// each block shows, or one for all.
double seamRatioInPlace(ImageView<const float> result, const Quilt& quilt,
                        std::span<const ImageView<const float>> sources);

// The mean gradient of the sources at seams, as above, over that inside copies: above 1, seams
// run through what is lively; below, through what is calm.
double seamSelection(ImageView<const float> source, const Quilt& quilt);

// The same of means over squares of 2 radius_px + 1 texels: steps of brightness between areas,
// which the eye finds where the ratio of single texels hides them among fine detail. The larger of
// the ratios along rows and along columns, since brushed metal hides nothing across its strokes
// that it would hide along them; a direction of fewer than 16 seam pairs is not judged.
double seamRatioOfAreas(ImageView<const float> result, const Quilt& quilt, int radius_px);

}  // namespace patina::quilting
