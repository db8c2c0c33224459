// SPDX-License-Identifier: GPL-3.0-or-later
// What comparing blocks by few components costs: how much worse, over the whole history, the chosen
// block is than the one that comparing whole histories would have chosen (Enrique et al. 2005,
// equations 3 and 5).
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"
#include "processing/image/progress.h"
#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

// An L-shaped overlap: it shows the source from `whole` on, and below its upper arm from `left` on.
struct Placement {
  PointPx whole, left;  // corners of blocks
};
std::vector<Placement> drawPlacements(SizePx corners, int count, std::uint64_t seed);

struct RankRegret {
  int rank = 0;
  double mean = 0;  // of (cost of the choice - least cost) / least cost, both over all components
  double same_share = 0;              // of the placements: the same choice
  std::vector<PointPx> choices = {};  // a placement
};
// `features` [h][w][k], components falling; blocks and overlaps as in quilting.
std::vector<RankRegret> rankRegret(ImageView<const float> features, const std::vector<int>& ranks,
                                   SizePx block, SizePx overlap,
                                   const std::vector<Placement>& placements, Progress& progress);

}  // namespace patina::quilting
