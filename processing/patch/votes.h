// SPDX-License-Identifier: GPL-3.0-or-later
// Which source texels the patches over a target texel show there.
#pragma once

#include <cstdint>
#include <span>

#include "processing/image/units.h"

namespace patina::patch {

struct Votes {
  std::span<const std::int32_t> centres;  // [h][w] of the target: y * source width + x
  SizePx target;
  int source_width = 0, reach = 2;
  bool wraps = false;
  // [h][w] of the target, or empty: the one source texel that is shown, -1 where patches vote.
  std::span<const std::int32_t> kept = {};

  std::size_t indexOf(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(target.width) +
           static_cast<std::size_t>(x);
  }
};

// Calls visit(source texel, dx, dy) for every patch over (x, y), that of (x + dx, y + dy). Returns
// how many there are.
template <class Visit>
int forEachVote(const Votes& v, int x, int y, const Visit& visit) {
  if (!v.kept.empty() && v.kept[v.indexOf(x, y)] >= 0) {
    visit(v.kept[v.indexOf(x, y)], 0, 0);
    return 1;
  }
  const int reach = v.reach, width = v.target.width, height = v.target.height;
  if (x >= reach && x < width - reach && y >= reach && y < height - reach) {
    for (int dy = -reach; dy <= reach; ++dy) {
      const std::int32_t* row = &v.centres[v.indexOf(x, y + dy)];
      for (int dx = -reach; dx <= reach; ++dx) visit(row[dx] - dy * v.source_width - dx, dx, dy);
    }
    return (2 * reach + 1) * (2 * reach + 1);
  }
  int votes = 0;
  for (int dy = -reach; dy <= reach; ++dy)
    for (int dx = -reach; dx <= reach; ++dx) {
      int tx = x + dx, ty = y + dy;
      if (v.wraps) {
        tx = (tx % width + width) % width;
        ty = (ty % height + height) % height;
      } else if (tx < 0 || tx >= width || ty < 0 || ty >= height) {
        continue;
      }
      visit(v.centres[v.indexOf(tx, ty)] - dy * v.source_width - dx, dx, dy);
      ++votes;
    }
  return votes;
}

}  // namespace patina::patch
