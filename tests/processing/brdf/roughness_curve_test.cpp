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

// A lobe that is nearly as wide as the diffuse part needs ever more strength to be wider still.
TEST(RoughnessCurve, TheWallBesideAValleyMakesNoDeeperValleyBeforeIt) {
  Curve cost = parabola(900, -0.7f);
  for (std::size_t j = 0; j < lanes::kCurve; ++j)
    cost[j] += 0.02f * std::exp(std::min(40 * (logR(j) + 0.7f), 15.0f));
  const Curve slope = slopesOf(cost);
  for (std::size_t j = 0; j + 1 < lanes::kCurve; ++j) {
    const Cubic cubic(cost, slope, j);
    const float least = std::min(cost[j], cost[j + 1]);
    const bool valley = cubic.leadsDown();
    for (float t = 0; t <= 1; t += 0.125f)
      EXPECT_GE(cubic.at(t), least - (valley ? 3 : 1e-3f * std::max(1.0f, cost[j + 1]))) << j;
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

// A valley that only a strength below 0 makes: with any material's all roughnesses cost alike.
TEST(RoughnessCurve, WhatATexelOnlySeemsToTellKeepsItsShape) {
  constexpr float kKnown = 10, kDeep = 3.5f;
  lanes::CostCurve curve;
  Curve valley;
  for (std::size_t j = 0; j < lanes::kCurve; ++j) {
    const float off = logR(j) + 0.4f, deep = kDeep * std::exp(-100 * off * off);
    valley[j] = kDeep - deep;
    curve.cost[j][0] = valley[j];
    curve.slope[j][0] = 200 * off * deep;
    curve.ks[j][0] = kDielectric - std::sqrt(deep / kKnown);
    curve.information[j][0] = kKnown;
  }
  FitState state({1, 1}, 1);
  keepCurve(state, MultiLightOptions{}, curve, 1, 0, 0, 0);
  const float least = *std::min_element(valley.begin(), valley.end());
  for (int j = 0; j < lanes::kCurve; ++j) {
    const auto k = static_cast<std::size_t>(j);
    const float own = state.curve.at(0, 0, j) - state.curve_moment.at(0, 0, j) * curve.ks[k][0];
    EXPECT_NEAR(own, valley[k] - least, 0.1f);
  }
}

}  // namespace
}  // namespace patina::brdf
