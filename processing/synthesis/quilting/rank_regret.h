// SPDX-License-Identifier: GPL-3.0-or-later
// What comparing blocks by few components costs: how much worse, over the whole history, the chosen
// block is than the one that comparing whole histories would have chosen (Enrique et al. 2005,
// equations 3 and 5).
#pragma once

#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::quilting {

struct RankRegret {
  int rank = 0;
  double mean = 0;  // of (cost of the choice - least cost) / least cost, both over all components
  double same_share = 0;  // of the placements: the same choice
};
// `features` [h][w][k], components falling; blocks and overlaps as in quilting, `placements`
// L-shaped overlaps of two places of the source each, drawn with `seed`.
std::vector<RankRegret> rankRegret(ImageView<const float> features, const std::vector<int>& ranks,
                                   SizePx block, SizePx overlap, int placements, std::uint64_t seed,
                                   Progress& progress);

}  // namespace patina::quilting
