// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/roughness_curve.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/brdf/roughness_pool.h"

namespace patina::brdf {
namespace {

constexpr float kMiddle = -1.1f;

Curve parabola(float curvature, float at = kMiddle) {
  Curve cost;
  for (std::size_t j = 0; j < lanes::kCurve; ++j)
    cost[j] = curvature * (logR(j) - at) * (logR(j) - at);
  return cost;
}

Curve slopesOfParabola(float curvature) {
  Curve slope;
  for (std::size_t j = 0; j < lanes::kCurve; ++j) slope[j] = 2 * curvature * (logR(j) - kMiddle);
  return slope;
}

TEST(RoughnessCurve, AParabolaOfOneTexelIsWiderByWhatTexelsDifferBy) {
  for (const float curvature : {1.0f, 500.0f, 1e5f}) {
    Curve cost = parabola(curvature);
    const float lowest = *std::min_element(cost.begin(), cost.end());
    const float share = 1 / (1 + curvature * kLeastSpread2);
    ofLikeTexels(cost, parabola(curvature), slopesOfParabola(curvature));
    for (std::size_t j = 0; j < lanes::kCurve; ++j) {
      const float off = logR(j) - kMiddle, wanted = (curvature * off * off - lowest) * share;
      if (wanted > kMostSay / 4) continue;
      EXPECT_NEAR(cost[j], wanted, 0.02f * wanted + 0.01f);
    }
  }
}

TEST(RoughnessCurve, NoTexelOutvotesManyOthers) {
  Curve cost = parabola(1e6f);
  ofLikeTexels(cost, parabola(1e6f), slopesOfParabola(1e6f));
  EXPECT_LE(*std::max_element(cost.begin(), cost.end()), 1.001f * kMostSay);
  EXPECT_GE(cost.front(), 0.99f * kMostSay);
}

// One texel of sixteen looks like the others and tells its own roughness well, they hardly tell
// theirs.
TEST(RoughnessCurve, AFewUnlikeTexelsDoNotOutvoteTheOthers) {
  constexpr SizePx kSize{24, 24};
  const MultiLightOptions options;
  FitState state(kSize, 1);
  for (float& v : state.look.texels()) v = 0.4f;
  for (float& v : state.misfit.texels()) v = 1;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const bool unlike = x % 4 == 0 && y % 4 == 0;
      const float at = unlike ? -1.6f : -0.2f, curvature = unlike ? 2000 : 2;
      lanes::CostCurve curve;
      for (std::size_t j = 0; j < lanes::kCurve; ++j) {
        curve.cost[j][0] = parabola(curvature, at)[j];
        curve.slope[j][0] = 2 * curvature * (logR(j) - at);
        curve.ks[j][0] = kDielectric;
        curve.information[j][0] = 1e4f;
      }
      keepCurve(state, options, curve, 1, x, y, 0);
    }
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, options, prior, progress);
  EXPECT_NEAR(prior.log_r.at(13, 13), -0.2f, 0.1f);
}

// A valley of a strength of its own, where with any material's strength all roughnesses cost alike.
TEST(RoughnessCurve, WhatATexelOnlySeemsToTellKeepsItsShape) {
  Curve cost;
  for (std::size_t j = 0; j < lanes::kCurve; ++j)
    cost[j] = 1.5f - 1.5f * std::exp(-200 * (logR(j) + 0.4f) * (logR(j) + 0.4f));
  const Curve before = cost, flat{};
  ofLikeTexels(cost, flat, flat);
  const float least = *std::min_element(before.begin(), before.end());
  for (std::size_t j = 0; j < lanes::kCurve; ++j) EXPECT_NEAR(cost[j], before[j] - least, 0.01f);
  Curve told = before;
  ofLikeTexels(told, before, slopesOf(before));
  EXPECT_LT(told[25] - *std::min_element(told.begin(), told.end()), before[25] - least - 0.02f);
}

}  // namespace
}  // namespace patina::brdf
