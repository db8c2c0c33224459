// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/repetition.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::quilting {
namespace {

// Blocks of 10x10; a copy may span two of them that overlap by 2.
RepetitionGuard guard(SizePx wrap = {}, double penalty = 1) {
  return {{100, 100}, {10, 10}, wrap, penalty, {18, 18}};
}

TEST(RepetitionGuard, LetsAllCornersBeAtFirst) {
  const Image<float> weights = guard().weights(0, 0);
  for (float w : weights.texels()) EXPECT_EQ(w, 1);
}

TEST(RepetitionGuard, PenalisesTheSameRegionSideBySideFarMoreThanFarAway) {
  RepetitionGuard g = guard();
  g.place(50, 50, 40, 40);
  EXPECT_GT(g.weights(58, 50).at(41, 41), 4);
  EXPECT_EQ(g.weights(58, 50).at(60, 60), 1);
  EXPECT_GT(g.weights(90, 50).at(40, 40), 1);
  EXPECT_LT(g.weights(90, 50).at(40, 40), 1.2);
  EXPECT_EQ(g.weights(150, 50).at(40, 40), 1);
}

TEST(RepetitionGuard, PenalisesLessTheFartherAndTheLessIsShared) {
  RepetitionGuard g = guard();
  g.place(50, 50, 40, 40);
  const auto at = [&](int x, int corner_x) { return g.weights(x, 50).at(corner_x, 40); };
  EXPECT_GT(at(75, 40), at(85, 40));
  EXPECT_GT(at(70, 40), at(70, 36));
}

TEST(RepetitionGuard, LetsACopyGoOnAsFarAsItMaySpan) {
  RepetitionGuard g = guard();
  g.place(50, 50, 40, 40);
  EXPECT_EQ(g.weights(58, 50).at(48, 40), 1);
  g.place(58, 50, 48, 40);
  EXPECT_TRUE(std::isinf(g.weights(66, 50).at(56, 40)));
}

TEST(RepetitionGuard, CountsACopyThatGoesOnALittleShiftedAsTheSame) {
  RepetitionGuard g = guard();
  g.place(50, 50, 40, 40);
  g.place(58, 50, 49, 40);  // one texel beyond where it would go on
  EXPECT_EQ(g.blocks()[0].patch, g.blocks()[1].patch);
  EXPECT_TRUE(std::isinf(g.weights(66, 50).at(56, 40)));
  EXPECT_TRUE(std::isinf(g.weights(66, 50).at(57, 40)));
}

TEST(RepetitionGuard, AllowsEverythingWithoutAPenalty) {
  RepetitionGuard g = guard({}, 0);
  g.place(50, 50, 40, 40);
  const Image<float> weights = g.weights(58, 50);
  for (float w : weights.texels()) EXPECT_EQ(w, 1);
}

TEST(RepetitionGuard, LooksAcrossTheEdgeOfAResultThatWraps) {
  RepetitionGuard open = guard(), wrapping = guard({200, 200});
  for (RepetitionGuard* g : {&open, &wrapping}) g->place(2, 50, 40, 40);
  EXPECT_EQ(open.weights(195, 50).at(41, 41), 1);
  EXPECT_GT(wrapping.weights(195, 50).at(41, 41), 4);
}

TEST(RepetitionGuard, MeasuresACopyAcrossTheEdgeOfAResultThatWraps) {
  RepetitionGuard g = guard({200, 200});
  g.place(195, 50, 40, 40);
  g.place(3, 50, 48, 40);
  EXPECT_EQ(g.blocks()[0].patch, g.blocks()[1].patch);
  EXPECT_EQ(g.weights(3, 58).at(48, 48), 1);
  EXPECT_TRUE(std::isinf(g.weights(11, 50).at(56, 40)));
}

}  // namespace
}  // namespace patina::quilting
