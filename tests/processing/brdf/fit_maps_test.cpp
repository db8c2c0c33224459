// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/fit_maps.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace patina::brdf {
namespace {

constexpr SizePx kSize{24, 24};

// Costs of a valley at ln r = `at`, of curvature 2 `weight`.
void plantCurve(FitState& state, int x, int y, float at, float weight) {
  for (int j = 0; j < lanes::kCurve; ++j) {
    const float off = lanes::curveLogR(j) - at;
    state.curve.at(x, y, j) = weight * off * off;
    state.curve_slope.at(x, y, j) = 2 * weight * off;
  }
}

FitState plainState() {
  FitState state(kSize, 1);
  for (float& v : state.look.texels()) v = 0.4f;
  for (float& v : state.curve_specular.texels()) v = kDielectric;
  for (float& v : state.misfit.texels()) v = 1;
  return state;
}

float certaintyOf(const FitState& state) {
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  return prior.log_r_weight.at(12, 12);
}

TEST(FitMaps, WhatNobodyKnowsAloneNeighboursKnowTogether) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) plantCurve(state, x, y, -1.3f, 4);
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), -1.3f, 0.01f);
  EXPECT_GT(prior.log_r_weight.at(12, 12), 100);
}

TEST(FitMaps, UnlikeTexelsAreNotAsked) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      plantCurve(state, x, y, x < 12 ? -1.0f : -2.5f, 20);
      if (x >= 12) state.look.at(x, y) = 0.8f;
    }
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(10, 12), -1.0f, 0.02f);
  EXPECT_NEAR(prior.log_r.at(14, 12), -2.5f, 0.02f);
}

TEST(FitMaps, ATexelIsAmongThoseAskedHoweverFarTheyReach) {
  for (const int reach : {1, 5, 7, 10, 11, 16, 23}) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        plantCurve(state, x, y, x == 12 && y == 12 ? -1.0f : -2.5f, 20);
        if (x != 12 || y != 12) state.look.at(x, y) = 0.9f;
      }
    MultiLightOptions options;
    options.neighbour_px = reach;
    PriorMaps prior(kSize, 1);
    Progress progress;
    poolRoughness(state, {}, options, prior, progress);
    EXPECT_NEAR(prior.log_r.at(12, 12), -1.0f, 0.05f) << reach;
  }
}

TEST(FitMaps, ATexelOfUnknownColourAsksItselfAlone) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) plantCurve(state, x, y, x == 12 ? -1.0f : -2.5f, 20);
  state.look.at(12, 12) = NAN;
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), -1.0f, 0.05f);
  EXPECT_LT(prior.log_r.at(13, 12), -2.3f);
}

TEST(FitMaps, NeighboursThatDifferAmongThemselvesHoldLessFirmly) {
  const auto certainty = [](float apart) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        plantCurve(state, x, y, -1.5f + ((x / 2 + y / 2) % 2 ? apart : -apart), 200);
    return certaintyOf(state);
  };
  EXPECT_LT(certainty(0.4f), 0.1f * certainty(0));
}

TEST(FitMaps, WhatTexelsHaveTogetherDoesNotAverageOut) {
  const auto certainty = [](float lamps) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        plantCurve(state, x, y, -1.3f, 4);
        state.lamps.at(x, y) = lamps;
      }
    return certaintyOf(state);
  };
  EXPECT_NEAR(certainty(1), 4 + kWideLogRWeight, 0.2f);
  EXPECT_LT(certainty(0.1f), 0.4f * certainty(0));
}

// Costs that leave the roughness open, and strengths that go with it from 0.01 up to 0.6.
TEST(FitMaps, WhatLightsLeaveOpenIsWhatDielectricsShow) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x)
      for (int j = 0; j < lanes::kCurve; ++j)
        state.curve_specular.at(x, y, j) = 0.01f * std::exp(0.15f * static_cast<float>(j));
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), lanes::curveLogR(9), 0.3f);  // and what lobes mostly are
  EXPECT_FLOAT_EQ(prior.dielectric_weight.at(12, 12), 1 / (0.02f * 0.02f));
}

TEST(FitMaps, LightsThatTellOverruleWhatMaterialsMostlyAre) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      plantCurve(state, x, y, -1.3f, 4);
      for (int j = 0; j < lanes::kCurve; ++j) state.curve_specular.at(x, y, j) = 0.6f;
    }
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), -1.3f, 0.01f);
  EXPECT_EQ(prior.dielectric_weight.at(12, 12), 0);
}

TEST(FitMaps, AnotherTimeStepIsAWitness) {
  const FitState state = plainState();  // flat costs
  const Image<float> specular(24, 24, 1, 0.2f), roughness(24, 24, 1, 0.3f), sure(24, 24, 1, 1.0f);
  PriorMaps prior(kSize, 1);
  Progress progress;
  const std::vector<FitBefore> before{{specular.view(), roughness.view(), sure.view()}};
  poolRoughness(state, before, MultiLightOptions{}, prior, progress);
  poolSpecular(state, before, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(3, 3), std::log(0.3f), 0.02f);
  EXPECT_NEAR(prior.specular.at(3, 3), 0.2f, 1e-5f);
}

TEST(FitMaps, WhatTheModelDoesNotMeetDoesNotAverageOutEither) {
  const auto certainty = [](float misfit) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        plantCurve(state, x, y, -1.3f, 4);
        state.misfit.at(x, y) = misfit * ((2 * x + y) % 5 ? 0.8f : 1.9f);  // chance alone: 1
      }
    return certaintyOf(state);
  };
  EXPECT_LT(certainty(10), 0.1f * certainty(1));
}

TEST(FitMaps, AParabolaOfOneTexelIsWiderByWhatTexelsDifferBy) {
  std::array<float, lanes::kCurve> cost{}, slope{};
  for (int j = 0; j < lanes::kCurve; ++j) {
    const float off = lanes::curveLogR(j) + 1.1f;
    cost[static_cast<std::size_t>(j)] = 3 + 500 * off * off;
    slope[static_cast<std::size_t>(j)] = 1000 * off;
  }
  ofLikeTexels(cost, slope);
  const float weight = 1 / (1 / 500.0f + 0.06f * 0.06f);
  for (int j = 0; j < lanes::kCurve; ++j) {
    const float off = lanes::curveLogR(j) + 1.1f;
    EXPECT_NEAR(cost[static_cast<std::size_t>(j)], weight * off * off,
                0.01f * weight * off * off + 0.01f);
    EXPECT_NEAR(slope[static_cast<std::size_t>(j)], 2 * weight * off,
                0.02f * weight * std::abs(off) + 0.05f);
  }
}

TEST(FitMaps, SpecularMeansCountByInformation) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const bool known = (x + y) % 4 == 0;
      state.own_specular.at(x, y) = known ? 0.1f : 0.5f;
      state.specular_weight.at(x, y) = known ? 1e5f : 1;
    }
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolSpecular(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.specular.at(12, 12), 0.1f, 0.01f);
}

}  // namespace
}  // namespace patina::brdf
