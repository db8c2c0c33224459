// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/layout_landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <numeric>

namespace patina::texture_optimization {
namespace {

constexpr int kSide = 16, kBlock = 4;

std::int32_t at(int x, int y) { return y * kSide + x; }

// One, of 2x2 texels at 6, 6.
Landmarks oneLandmark() {
  Landmarks out{.size = {kSide, kSide}, .count = 1, .of = std::vector<std::int32_t>(256, -1)};
  for (int y = 6; y < 8; ++y)
    for (int x = 6; x < 8; ++x) out.of[static_cast<std::size_t>(at(x, y))] = 0;
  return out;
}

std::vector<std::int32_t> places() {
  std::vector<std::int32_t> out;
  for (int y = 0; y + kBlock <= kSide; ++y)
    for (int x = 0; x + kBlock <= kSide; ++x) out.push_back(at(x, y));
  return out;
}

LayoutLandmarks landmarks(float even_copies = 4) {
  return {oneLandmark(), {kSide, kSide}, kBlock, places(), even_copies};
}

float nearCost(std::int32_t shown_there, int right, int below, std::int32_t place) {
  std::vector<float> costs(256);
  landmarks().addNear(shown_there, right, below, costs);
  return costs[static_cast<std::size_t>(place)];
}

TEST(LayoutLandmarks, CostTheMoreTheNearerAndNothingASideApart) {
  const std::int32_t whole = at(5, 5);
  const float near = nearCost(whole, 4, 0, whole), far = nearCost(whole, 12, 0, whole);
  EXPECT_GT(near, far);
  EXPECT_GT(far, 10);  // beside rims that cost 1
  EXPECT_GT(nearCost(whole, 0, -12, whole), 10);
  EXPECT_EQ(nearCost(whole, 17, 0, whole), 0);
  EXPECT_EQ(nearCost(whole, 12, 12, whole), 0);
}

TEST(LayoutLandmarks, CostLessWhereLessOfThemShows) {
  const std::int32_t whole = at(5, 5), half = at(7, 5), none = at(8, 5);
  EXPECT_LT(nearCost(whole, 8, 0, half), nearCost(whole, 8, 0, whole));
  EXPECT_GT(nearCost(whole, 8, 0, half), 0);
  EXPECT_EQ(nearCost(whole, 8, 0, none), 0);
}

TEST(LayoutLandmarks, CostNothingWhereOneCopyGoesOnInTheNextBlock) {
  // The left half here, the right half in the block at its right.
  EXPECT_EQ(nearCost(at(7, 5), 4, 0, at(3, 5)), 0);
  EXPECT_GT(nearCost(at(7, 5), 4, 0, at(4, 5)), 0);
}

TEST(LayoutLandmarks, AreOwedWhatEvenUseWouldShowAndNoMore) {
  LayoutLandmarks some = landmarks(2);
  const auto owed = [&](std::int32_t place) {
    std::vector<float> costs(256);
    some.takeOwed(costs);
    return -costs[static_cast<std::size_t>(place)];
  };
  const float none_shown = owed(at(5, 5));
  EXPECT_GT(none_shown, 1);
  EXPECT_FLOAT_EQ(owed(at(7, 5)), none_shown / 2);  // half of it shows
  EXPECT_EQ(owed(at(8, 5)), 0);
  some.appear(at(5, 5));
  EXPECT_FLOAT_EQ(owed(at(5, 5)), none_shown / 2);
  some.appear(at(5, 5));
  EXPECT_EQ(owed(at(5, 5)), 0);
  some.appear(at(5, 5));
  EXPECT_EQ(owed(at(5, 5)), 0);
  some.vanish(at(5, 5));
  some.vanish(at(5, 5));
  EXPECT_FLOAT_EQ(owed(at(5, 5)), none_shown / 2);
}

TEST(LayoutLandmarks, WeighMismatchWhereTheyAreCut) {
  EXPECT_GT(landmarks().weight(static_cast<std::size_t>(at(6, 7))), 1);
  EXPECT_EQ(landmarks().weight(static_cast<std::size_t>(at(5, 7))), 1);
  EXPECT_EQ(LayoutLandmarks().weight(0), 1);
}

TEST(LayoutLandmarks, CostNothingWhereThereAreNone) {
  LayoutLandmarks none;
  none.appear(0);
  std::vector<float> costs(256);
  none.addNear(0, 4, 0, costs);
  none.takeOwed(costs);
  EXPECT_EQ(std::accumulate(costs.begin(), costs.end(), 0.0f), 0);
}

}  // namespace
}  // namespace patina::texture_optimization
