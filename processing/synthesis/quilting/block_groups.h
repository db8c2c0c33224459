// SPDX-License-Identifier: GPL-3.0-or-later
// Which blocks may be worked on at the same time, so that the result is that of one after another.
#pragma once

#include <cstddef>
#include <vector>

#include "processing/image/image.h"
#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

// Indices of `corners` (upper left, of blocks of one size) in groups: blocks of one group neither
// share nor neighbour a texel, and of two that do, the earlier one's group comes first.
// `wrapping_canvas` is not 0x0 where the result wraps around. O(area of the blocks / 64).
std::vector<std::vector<std::size_t>> blockGroups(const std::vector<PointPx>& corners, SizePx block,
                                                  SizePx wrapping_canvas = {});

}  // namespace patina::quilting
