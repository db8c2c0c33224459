// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/votes.h"

#include <gtest/gtest.h>

#include <vector>

namespace patina::patch {
namespace {

constexpr int kSource = 20;

// Every patch shows what lies at its own place, moved by (3, 4).
std::vector<std::int32_t> moved(SizePx target) {
  std::vector<std::int32_t> out;
  for (int y = 0; y < target.height; ++y)
    for (int x = 0; x < target.width; ++x) out.push_back((y + 4) * kSource + x + 3);
  return out;
}

TEST(Votes, AreOneForEachPatchOverATexel) {
  const std::vector<std::int32_t> centres = moved({8, 6});
  Votes votes{centres, {8, 6}, kSource, 2};
  const auto countAt = [&](int x, int y) {
    return forEachVote(votes, x, y, [&](std::int32_t texel, int, int) {
      EXPECT_EQ(texel, (y + 4) * kSource + x + 3);
    });
  };
  EXPECT_EQ(countAt(4, 3), 25);
  EXPECT_EQ(countAt(0, 0), 9);
  EXPECT_EQ(countAt(7, 3), 15);
}

TEST(Votes, ComeFromTheOtherSideWhenTheTargetWraps) {
  const std::vector<std::int32_t> centres = moved({8, 6});
  Votes votes{centres, {8, 6}, kSource, 1, true};
  std::vector<std::int32_t> shown;
  EXPECT_EQ(forEachVote(votes, 0, 0, [&](std::int32_t texel, int, int) { shown.push_back(texel); }),
            9);
  // The patch at (7, 5) shows (10, 9) there, one to its right and below: (11, 10).
  EXPECT_EQ(shown[0], 10 * kSource + 11);
}

TEST(Votes, AreTheKeptTexelAloneWhereThereIsOne) {
  const std::vector<std::int32_t> centres = moved({8, 6});
  std::vector<std::int32_t> kept(48, -1);
  kept[3 * 8 + 4] = 5;
  const Votes votes{centres, {8, 6}, kSource, 2, false, kept};
  EXPECT_EQ(forEachVote(votes, 4, 3,
                        [&](std::int32_t texel, int dx, int dy) {
                          EXPECT_EQ(texel, 5);
                          EXPECT_EQ(dx, 0);
                          EXPECT_EQ(dy, 0);
                        }),
            1);
}

}  // namespace
}  // namespace patina::patch
