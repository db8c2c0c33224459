// SPDX-License-Identifier: GPL-3.0-or-later
// What choices by few components cost against equation 3 itself (Enrique et al. 2005): over every
// frame and channel as displayed, nothing left out.
#pragma once

#include <span>
#include <vector>

#include "processing/synthesis/quilting/rank_regret.h"
#include "processing/synthesis/quilting/ttf_features.h"

namespace patina::quilting {

struct HistoryRegret {
  double mean = 0;        // of (cost of the choice - least cost) / least cost
  double same_share = 0;  // of the placements: the choice was the best
};
// One for each of `chosen`, which chose for `placements` (or for more, these first). `weight`: of
// each frame, as blocks are compared (ttf_features.h). The least cost is that of all corners: found
// by FFT, then the few least and all choices summed exactly. Reads the input twice, frame by frame;
// memory: some planes of the source's size and one a placement; O(frames * placements) transforms.
std::vector<HistoryRegret> historyRegret(const QuiltingSource& source,
                                         std::span<const float> weight, SizePx block,
                                         SizePx overlap, const std::vector<Placement>& placements,
                                         const std::vector<RankRegret>& chosen, Progress& progress);

}  // namespace patina::quilting
