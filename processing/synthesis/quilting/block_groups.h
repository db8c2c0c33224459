// SPDX-License-Identifier: GPL-3.0-or-later
// Which blocks may be worked on at the same time, so that the result is that of one after another.
#pragma once

#include <cstddef>
#include <vector>

#include "processing/image/image.h"
#include "processing/synthesis/quilting/quilting.h"

namespace patina::quilting {

inline constexpr int kCellPx = 8;
// Cells that the texels [from - 1, to + 1) lie in, each once; `length` is above 0 where they wrap.
std::vector<int> cellsOf(int from, int to, int length);

// Indices of `corners` (upper left, of blocks of one size) in groups: blocks of one group neither
// share nor neighbour a cell, and of two that do, the earlier one's group comes first.
// `wrapping_canvas` is not 0x0 where the result wraps around. O(area of the blocks / 64).
std::vector<std::vector<std::size_t>> blockGroups(const std::vector<PointPx>& corners, SizePx block,
                                                  SizePx wrapping_canvas = {});

}  // namespace patina::quilting
