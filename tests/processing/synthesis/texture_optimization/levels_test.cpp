// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/levels.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina::texture_optimization {
namespace {

TEST(Levels, AverageOverTheAreaOfEachTexel) {
  Image<std::int16_t> in(5, 4, 8);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) in.at(x, y, 3) = static_cast<std::int16_t>(100 * x);
  const Image<std::int16_t> out = averaged(in, {2, 2});
  EXPECT_EQ(out.at(0, 1, 3), 80);   // 0, 100, and half of 200, over 2.5
  EXPECT_EQ(out.at(1, 1, 3), 320);  // half of 200, 300, 400
  EXPECT_EQ(out.at(1, 1, 2), 0);
}

TEST(Levels, UseATexelWhereAllBeneathMayBeUsed) {
  std::vector<std::uint8_t> mask(5 * 4, 1);
  mask[2] = 0;  // (2, 0): beneath both
  EXPECT_EQ(allBeneath(mask, {5, 4}, {2, 2}), (std::vector<std::uint8_t>{0, 0, 1, 1}));
  EXPECT_TRUE(allBeneath({}, {5, 4}, {2, 2}).empty());
}

TEST(Levels, KeepATexelWhereAllBeneathAreKept) {
  std::vector<std::int32_t> kept(8 * 4, -1);
  for (const std::size_t x : {2u, 3u})
    for (const std::size_t y : {0u, 1u})
      kept[y * 8 + x] = static_cast<std::int32_t>((y + 4) * 20 + x + 6);
  kept[0] = 5;
  const std::vector<std::int32_t> smaller = keptBeneath(kept, {8, 4}, {4, 2}, {20, 20}, {10, 10});
  EXPECT_EQ(smaller[1], 2 * 10 + 4);
  EXPECT_EQ(std::count(smaller.begin(), smaller.end(), -1), 7);
}

TEST(Levels, FindWhetherAWholePatchIsLeft) {
  std::vector<std::uint8_t> mask(9 * 8, 1);
  EXPECT_TRUE(holdsPatch(mask, {9, 8}, 7));
  mask[3 * 9 + 4] = 0;
  EXPECT_FALSE(holdsPatch(mask, {9, 8}, 5));
  EXPECT_TRUE(holdsPatch(mask, {9, 8}, 3));
  EXPECT_TRUE(holdsPatch(std::vector<std::uint8_t>(49, 1), {7, 7}, 7));
  EXPECT_FALSE(holdsPatch({}, {4, 8}, 5));
}

TEST(Levels, RefineEachPatchIntoFourThatContinueIt) {
  const std::vector<std::int32_t> coarse{3 * 10 + 4, 5 * 10 + 6};
  const std::vector<std::int32_t> fine = refined(coarse, {10, 10}, {2, 1}, {20, 20}, {4, 2}, 2);
  EXPECT_EQ(fine, (std::vector<std::int32_t>{6 * 20 + 8, 6 * 20 + 9, 10 * 20 + 12, 10 * 20 + 13,
                                             7 * 20 + 8, 7 * 20 + 9, 11 * 20 + 12, 11 * 20 + 13}));
}

TEST(Levels, ScatterCentresOverAllOfTheSource) {
  const std::vector<std::int32_t> centres = scattered({12, 9}, {60, 60}, {});
  ASSERT_EQ(centres.size(), 3600u);
  std::vector<int> uses(12 * 9, 0);
  for (const std::int32_t c : centres) ++uses[static_cast<std::size_t>(c)];
  for (std::size_t y = 0; y < 9; ++y)
    for (std::size_t x = 0; x < 12; ++x)
      EXPECT_EQ(uses[y * 12 + x] > 0, x >= 2 && x < 10 && y >= 2 && y < 7);
}

}  // namespace
}  // namespace patina::texture_optimization
