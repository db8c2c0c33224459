// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/block_groups.h"

#include <algorithm>

namespace patina::quilting {

std::vector<int> cellsOf(int from, int to, int length) {
  std::vector<int> cells;
  for (int v = from - 1; v <= to; ++v) {
    const int on = length > 0 ? (v % length + length) % length : std::max(v, 0);
    if (cells.empty() || cells.back() != on / kCellPx) cells.push_back(on / kCellPx);
  }
  return cells;
}

std::vector<std::vector<std::size_t>> blockGroups(const std::vector<PointPx>& corners, SizePx block,
                                                  SizePx wrapping_canvas) {
  SizePx reach{wrapping_canvas.width, wrapping_canvas.height};
  for (const PointPx& corner : corners) {
    reach.width = std::max(reach.width, corner.x + block.width + 1);
    reach.height = std::max(reach.height, corner.y + block.height + 1);
  }
  Image<std::int32_t> next(reach.width / kCellPx + 1, reach.height / kCellPx + 1, 1);
  std::vector<std::vector<std::size_t>> groups;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::vector<int> columns =
        cellsOf(corners[i].x, corners[i].x + block.width, wrapping_canvas.width);
    const std::vector<int> rows =
        cellsOf(corners[i].y, corners[i].y + block.height, wrapping_canvas.height);
    std::int32_t group = 0;
    for (int y : rows)
      for (int x : columns) group = std::max(group, next.at(x, y));
    for (int y : rows)
      for (int x : columns) next.at(x, y) = group + 1;
    groups.resize(std::max(groups.size(), static_cast<std::size_t>(group) + 1));
    groups[static_cast<std::size_t>(group)].push_back(i);
  }
  return groups;
}

}  // namespace patina::quilting
