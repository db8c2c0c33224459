// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/rank_regret.h"

#include <gtest/gtest.h>

#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {
namespace {

TEST(RankRegret, FallsWithTheRankToNothingAtAllComponents) {
  const Image<float> f = waveTexture({70, 70}, 6);
  Progress progress;
  const std::vector<RankRegret> regrets =
      rankRegret(f.view(), {1, 3, 6}, {16, 16}, {5, 5}, drawPlacements({55, 55}, 25, 1), progress);
  ASSERT_EQ(regrets.size(), 3u);
  EXPECT_GT(regrets[0].mean, regrets[1].mean);
  EXPECT_LT(regrets[0].same_share, 1);
  EXPECT_EQ(regrets[2].mean, 0);
  EXPECT_EQ(regrets[2].same_share, 1);
  EXPECT_EQ(regrets[2].rank, 6);
}

}  // namespace
}  // namespace patina::quilting
