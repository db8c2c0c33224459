// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/block_groups.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace patina::quilting {
namespace {

constexpr SizePx kBlock{20, 12};

std::vector<PointPx> rasterOf(int columns, int rows, int step_x, int step_y) {
  std::vector<PointPx> corners;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) corners.push_back({c * step_x, r * step_y});
  return corners;
}

int apart(int a, int b, int length) {
  const int d = std::abs(a - b);
  return length > 0 ? std::min(d, length - d) : d;
}

bool meet(PointPx a, PointPx b, SizePx canvas) {
  return apart(a.x, b.x, canvas.width) <= kBlock.width &&
         apart(a.y, b.y, canvas.height) <= kBlock.height;
}

void expectInOrder(const std::vector<PointPx>& corners, SizePx canvas) {
  const auto groups = blockGroups(corners, kBlock, canvas);
  std::vector<int> group_of(corners.size(), -1);
  for (std::size_t g = 0; g < groups.size(); ++g)
    for (std::size_t i : groups[g]) {
      EXPECT_EQ(group_of[i], -1);
      group_of[i] = static_cast<int>(g);
    }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    ASSERT_GE(group_of[i], 0);
    for (std::size_t j = 0; j < i; ++j) {
      if (meet(corners[i], corners[j], canvas)) {
        EXPECT_GT(group_of[i], group_of[j]) << i << " and " << j;
      }
    }
  }
}

TEST(BlockGroups, KeepTheOrderOfBlocksThatMeet) {
  expectInOrder(rasterOf(7, 6, 12, 7), {});
  expectInOrder(rasterOf(5, 4, 10, 6), {});
  expectInOrder({{30, 40}, {0, 0}, {49, 41}, {50, 52}, {51, 53}}, {});
}

TEST(BlockGroups, KnowThatOppositeSidesMeetWhereTheResultWraps) {
  expectInOrder(rasterOf(7, 6, 12, 7), {84, 42});
}

TEST(BlockGroups, HoldSeveralBlocksAtATimeWhereTheyLieApart) {
  EXPECT_EQ(blockGroups(rasterOf(4, 4, 40, 30), kBlock).size(), 1u);
  EXPECT_LE(blockGroups(rasterOf(12, 12, 12, 7), kBlock).size(), 72u);
}

}  // namespace
}  // namespace patina::quilting
