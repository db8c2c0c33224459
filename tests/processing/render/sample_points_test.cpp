// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/sample_points.h"

#include <gtest/gtest.h>

#include <set>

namespace patina::render {
namespace {

TEST(SamplePoints, ArePermutedWithoutLoss) {
  for (const std::uint32_t n : {1u, 2u, 5u, 64u, 100u, 777u}) {
    std::set<std::uint32_t> seen;
    for (std::uint32_t i = 0; i < n; ++i) seen.insert(permuted(i, n, 0x1234567 * n));
    EXPECT_EQ(seen.size(), n);
    EXPECT_EQ(*seen.rbegin(), n - 1);
  }
}

TEST(SamplePoints, SpreadMoreEvenlyThanChance) {
  int most = 0;
  for (std::uint64_t pixel = 0; pixel < 20; ++pixel) {
    int in_cell[8][8] = {};
    for (std::uint32_t i = 0; i < 256; ++i) {
      SamplePoints points(pixel, i, 256);
      points.next();
      const auto [x, y] = points.next();
      ASSERT_TRUE(x >= 0 && x < 1 && y >= 0 && y < 1);
      most = std::max(most, ++in_cell[static_cast<int>(x * 8)][static_cast<int>(y * 8)]);
    }
  }
  EXPECT_LE(most, 8);  // 4 on average; by chance 12 and more
}

TEST(SamplePoints, OfTwoDecisionsDoNotHangTogether) {
  double together = 0;
  for (std::uint64_t pixel = 0; pixel < 50; ++pixel)
    for (std::uint32_t i = 0; i < 64; ++i) {
      SamplePoints points(pixel, i, 64);
      const float a = points.next()[0], b = points.next()[0];
      together += (a - 0.5) * (b - 0.5) * 12 / (50 * 64);
    }
  EXPECT_NEAR(together, 0, 0.06);
}

}  // namespace
}  // namespace patina::render
