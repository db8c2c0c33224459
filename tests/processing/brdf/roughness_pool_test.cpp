// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/roughness_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace patina::brdf {
namespace {

constexpr SizePx kSize{24, 24};

// Entry j: the cost of its roughness alone, and the strength that goes with it, known that well and
// to 6 % at most.
void plantEntry(FitState& state, int x, int y, int j, float cost, float ks, float known = 1e6f) {
  const float information = 1 / (1 / known + 0.0036f * ks * ks);
  state.curve.at(x, y, j) = cost + information * ks * ks;
  state.curve_moment.at(x, y, j) = information * ks;
  state.curve_information.at(x, y, j) = information;
}

// Costs of a valley at ln r = `at`, of curvature 2 `weight`.
void plantCurve(FitState& state, int x, int y, float at, float weight, float ks = kDielectric) {
  for (int j = 0; j < lanes::kCurve; ++j) {
    const float off = lanes::curveLogR(j) - at;
    plantEntry(state, x, y, j, weight * off * off, ks);
  }
}

template <class Body>
void forEachTexel(const Body& body) {
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) body(x, y);
}

FitState plainState() {
  FitState state(kSize, 1);
  for (float& v : state.look.texels()) v = 0.4f;
  for (float& v : state.misfit.texels()) v = 1;
  forEachTexel([&](int x, int y) { plantCurve(state, x, y, 0, 0); });
  return state;
}

float certaintyOf(const FitState& state) {
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  return prior.log_r_weight.at(12, 12);
}

TEST(RoughnessPool, WhatNobodyKnowsAloneNeighboursKnowTogether) {
  FitState state = plainState();
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) plantCurve(state, x, y, -1.3f, 4);
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), -1.3f, 0.01f);
  EXPECT_GT(prior.log_r_weight.at(12, 12), 100);
}

TEST(RoughnessPool, UnlikeTexelsAreNotAsked) {
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

TEST(RoughnessPool, ATexelIsAmongThoseAskedHoweverFarTheyReach) {
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

TEST(RoughnessPool, ATexelOfUnknownColourAsksItselfAlone) {
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

TEST(RoughnessPool, NeighboursThatDifferAmongThemselvesHoldLessFirmly) {
  const auto certainty = [](float apart) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        plantCurve(state, x, y, -1.5f + ((x / 2 + y / 2) % 2 ? apart : -apart), 200);
    return certaintyOf(state);
  };
  EXPECT_LT(certainty(0.4f), 0.1f * certainty(0));
}

TEST(RoughnessPool, WhatTexelsHaveTogetherDoesNotAverageOut) {
  const auto certainty = [](float lamps) {
    FitState state = plainState();
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        plantCurve(state, x, y, -1.3f, 4);
        state.lamps.at(x, y) = lamps;
      }
    return certaintyOf(state);
  };
  EXPECT_NEAR(certainty(1), 4 + 1, 0.3f);  // and that most surfaces are rough
  EXPECT_LT(certainty(0.1f), 0.4f * certainty(0));
}

// Costs that leave the roughness open, and strengths that go with it from 0.6 down to 0.01.
TEST(RoughnessPool, WhatLightsLeaveOpenIsWhatDielectricsShow) {
  FitState state = plainState();
  forEachTexel([&](int x, int y) {
    for (int j = 0; j < lanes::kCurve; ++j)
      plantEntry(state, x, y, j, 0, 0.6f * std::exp(-0.15f * static_cast<float>(j)));
  });
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_GT(prior.log_r.at(12, 12), lanes::curveLogR(16));        // 0.054
  EXPECT_LT(prior.log_r.at(12, 12), lanes::curveLogR(22));        // 0.022
  EXPECT_NEAR(prior.expected_specular.at(12, 12), 0.04f, 0.02f);  // of all alike: 0.14
  EXPECT_FLOAT_EQ(prior.expected_weight.at(12, 12), 1 / (0.02f * 0.02f));
}

TEST(RoughnessPool, LightsThatTellOverruleWhatMaterialsMostlyAre) {
  FitState state = plainState();
  forEachTexel([&](int x, int y) { plantCurve(state, x, y, -1.3f, 4, 0.6f); });
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), -1.3f, 0.01f);
  EXPECT_NEAR(prior.expected_specular.at(12, 12), 0.6f, 1e-3f);
  EXPECT_EQ(prior.expected_weight.at(12, 12), 0);
}

// At entry 20 all texels have one strength; elsewhere each explains a little more with one of its
// own, two of its own sigmas from the others'.
TEST(RoughnessPool, TexelsShareTheirStrength) {
  FitState state = plainState();
  forEachTexel([&](int x, int y) {
    for (int j = 0; j < lanes::kCurve; ++j) {
      const float other = (x + y) % 2 ? 0.02f : -0.02f;
      plantEntry(state, x, y, j, j == 20 ? 1.0f : 0.0f, j == 20 ? 0.03f : 0.03f + other, 1e4f);
    }
  });
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(12, 12), lanes::curveLogR(20), 0.05f);
  EXPECT_NEAR(prior.expected_specular.at(12, 12), 0.03f, 2e-3f);
}

// A texel by itself: steep towards narrow lobes, nearly flat towards wide ones.
TEST(RoughnessPool, WhereMuchIsLeftOpenTheMeanIsAskedAndNotTheLeast) {
  FitState state = plainState();
  forEachTexel([&](int x, int y) {
    for (int j = 0; j < lanes::kCurve; ++j) {
      const float off = lanes::curveLogR(j) - lanes::curveLogR(14);
      plantEntry(state, x, y, j, off < 0 ? 200 * off * off : off * off, kDielectric);
    }
  });
  MultiLightOptions options;
  options.neighbours = false;
  PriorMaps prior(kSize, 1);
  Progress progress;
  poolRoughness(state, {}, options, prior, progress);
  EXPECT_GT(prior.log_r.at(12, 12), lanes::curveLogR(14) + 0.3f);
  EXPECT_LT(prior.log_r_weight.at(12, 12), 20);
}

TEST(RoughnessPool, AnotherTimeStepIsAWitness) {
  const FitState state = plainState();  // flat costs
  const Image<float> specular(24, 24, 1, 0.2f), roughness(24, 24, 1, 0.3f), sure(24, 24, 1, 1.0f);
  PriorMaps prior(kSize, 1);
  Progress progress;
  const std::vector<FitBefore> before{{specular.view(), roughness.view(), sure.view()}};
  poolRoughness(state, before, MultiLightOptions{}, prior, progress);
  EXPECT_NEAR(prior.log_r.at(3, 3), std::log(0.3f), 0.02f);
}

TEST(RoughnessPool, WhatTheModelDoesNotMeetDoesNotAverageOutEither) {
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

}  // namespace
}  // namespace patina::brdf
