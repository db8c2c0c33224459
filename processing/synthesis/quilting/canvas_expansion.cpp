// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "processing/patch/squared_difference.h"
#include "processing/synthesis/quilting/block_groups.h"
#include "processing/synthesis/quilting/canvas.h"

namespace patina::quilting {

Canvas::Copy Canvas::copyAt(int x, int y) const {
  const int u = wrapped(x, size_.width), v = wrapped(y, size_.height);
  return {index_.at(u, v), source_.at(u, v, 0), source_.at(u, v, 1)};
}

// Of two neighbours, `there` a step from `here`: how far the two copies are apart at either.
double Canvas::seamCost(const Copy& here, const Copy& there, int step_x, int step_y) const {
  const bool one_time = !warps_ || here.index == there.index;
  if (one_time && there.x - here.x == step_x && there.y - here.y == step_y) return 0;
  const std::size_t direction = step_x != 0 ? 0 : 1;
  const auto isSource = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < features_.width && y < features_.height;
  };
  thread_local std::array<std::vector<float>, 2> room;
  const auto shown = [&](const Copy& copy, int dx, int dy, std::size_t place) {
    if (!warps_) return across(direction).texel(copy.x + dx, copy.y + dy).data();
    room[place].resize(static_cast<std::size_t>(across_channels_));
    shownAcross(direction, copy.index, copy.x + dx, copy.y + dy, room[place].data());
    return static_cast<const float*>(room[place].data());
  };
  const auto apart = [&](const float* a, const float* b) {
    return static_cast<double>(std::sqrt(patch::squaredDifference(a, b, across_channels_)));
  };
  const bool on = isSource(here.x + step_x, here.y + step_y),
             back = isSource(there.x - step_x, there.y - step_y);
  double cost = 0;
  if (back) cost += apart(shown(here, 0, 0, 0), shown(there, -step_x, -step_y, 1));
  if (on) cost += apart(shown(here, step_x, step_y, 0), shown(there, 0, 0, 1));
  if (on && back) return cost;
  return 2 * (on || back ? cost : apart(shown(here, 0, 0, 0), shown(there, 0, 0, 1)));
}

std::int64_t Canvas::expand(int x, int y, int index, int source_x, int source_y) {
  const int width = block_.width, height = block_.height;
  patch::GridTerms terms{Image<double>(width, height, 1), Image<double>(width, height, 1),
                         Image<double>(width, height, 1)};
  const auto laid = [&](int i, int j) { return Copy{index, source_x + i, source_y + j}; };
  // Neighbours within the block; 0: what is there stays, 1: the block.
  const auto join = [&](int i, int j, int di, int dj, double& pair) {
    const Copy a = copyAt(x + i, y + j), b = copyAt(x + i + di, y + j + dj), new_a = laid(i, j),
               new_b = laid(i + di, j + dj);
    if (a == new_a && b == new_b) return;
    const double weight = weightAt(dj != 0, x + i, y + j);
    const double stay = weight * seamCost(a, b, di, dj),
                 enter = weight * seamCost(a, new_b, di, dj),
                 leave = weight * seamCost(new_a, b, di, dj);
    terms.one.at(i, j) += leave - stay;
    terms.one.at(i + di, j + dj) -= leave;
    pair = std::max(0.0, enter + leave - stay);
  };
  // A neighbour outside stays as it is.
  const auto border = [&](int i, int j, int di, int dj) {
    if (!isCovered(x + i + di, y + j + dj)) return;
    const Copy outside = copyAt(x + i + di, y + j + dj);
    const double weight = weightAt(dj != 0, x + i + std::min(di, 0), y + j + std::min(dj, 0));
    terms.one.at(i, j) += weight * (seamCost(laid(i, j), outside, di, dj) -
                                    seamCost(copyAt(x + i, y + j), outside, di, dj));
  };
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (i + 1 < width) join(i, j, 1, 0, terms.right.at(i, j));
      if (j + 1 < height) join(i, j, 0, 1, terms.down.at(i, j));
      if (i == 0) border(i, j, -1, 0);
      if (i + 1 == width) border(i, j, 1, 0);
      if (j == 0) border(i, j, 0, -1);
      if (j + 1 == height) border(i, j, 0, 1);
    }
  if (!kept_.empty()) {  // dearer than all that a texel could save
    double dearest = 1;
    for (std::size_t i = 0; i < terms.one.texels().size(); ++i)
      dearest = std::max({dearest, std::abs(terms.one.texels()[i]), terms.right.texels()[i],
                          terms.down.texels()[i]});
    for (int j = 0; j < height; ++j)
      for (int i = 0; i < width; ++i)
        if (isKept(x + i, y + j)) terms.one.at(i, j) = 10 * dearest;
  }
  const Image<std::uint8_t> take = patch::minimumChoice(terms);
  std::int64_t changed = 0;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      if (!take.at(i, j) || copyAt(x + i, y + j) == laid(i, j)) continue;
      const auto to = sourceAt(x + i, y + j);
      to[0] = source_x + i;
      to[1] = source_y + j;
      const int u = wrapped(x + i, size_.width), v = wrapped(y + j, size_.height);
      index_.at(u, v) = index;
      changed_.at(u / kCellPx, v / kCellPx) = step_;
      ++changed;
    }
  return changed;
}

bool Canvas::isChangedSince(int x, int y, int step) const {
  for (int v : cellsOf(y, y + block_.height, wraps_ ? size_.height : 0))
    for (int u : cellsOf(x, x + block_.width, wraps_ ? size_.width : 0))
      if (u < changed_.width() && v < changed_.height() && changed_.at(u, v) > step) return true;
  return false;
}

}  // namespace patina::quilting
