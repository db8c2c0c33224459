// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

TEST(LaneSteps, ReachTheTruthFromThePhotometricStart) {
  const Planted planted{0.3f, 0.2f, 0.2f};
  Samples samples = plant(planted);
  Estimate at;
  photometricStart(samples, at);
  scanRoughness(Model::kGgx, samples, at, noPrior());
  Equations q;
  MultiLightOptions options;
  options.steps = 8;
  refine(options, samples, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(std::exp(at.u[k]), 0.2f, 2e-3f);
    EXPECT_NEAR(at.ks[k], 0.2f, 2e-3f);
    EXPECT_NEAR(at.kd[k], 0.3f, 2e-3f);
    EXPECT_NEAR(at.nx[k], truthOf(planted).nx[k], 1e-3f);
  }
}

TEST(LaneSteps, TheScanFindsTheNearestRoughness) {
  Samples samples = plant({0.3f, 0.2f, 0.16f});
  Estimate at = truthOf({0.3f, 0.2f, 0.16f});
  scanRoughness(Model::kGgx, samples, at, noPrior());
  EXPECT_NEAR(std::exp(at.u[0]), 0.16f, 1e-3f);
}

TEST(LaneSteps, AnOutlierLosesWeightAndAShadowAllOfIt) {
  Samples samples = plant({});
  Estimate at = truthOf({});
  for (std::size_t i = 0; i < samples.count; ++i)  // a spread of its own for every level
    for (int k = 0; k < kLanes; ++k) samples.light[i].y[k] += (i % 2 ? 1.0f : -1.0f) * 2e-3f;
  samples.light[2].y[0] += 0.03f;
  samples.light[5].y[0] *= 0.1f;
  Equations q;
  evaluate(Model::kGgx, samples, at, noPrior(), q);
  at = truthOf({});
  reweigh(samples, at);
  EXPECT_LT(samples.light[2].weight[0], 0.2f * samples.light[2].noise[0]);
  EXPECT_EQ(samples.light[5].weight[0], 0);
  EXPECT_GT(samples.light[7].weight[0], 0.7f * samples.light[7].noise[0]);
}

TEST(LaneSteps, WhatIsWithinThreeSpreadsCountsInFullAndAnOutlierStillDoesNot) {
  Samples samples = plant({});
  for (Light& light : samples.light)
    for (int k = 0; k < kLanes; ++k) light.weight[k] = light.noise[k] / (1 + 1.25f * 1.25f);
  samples.light[2].weight[0] = 0.1f * samples.light[2].noise[0];
  samples.light[5].weight[0] = 0;
  countInFull(samples);
  EXPECT_NEAR(samples.light[7].weight[0], samples.light[7].noise[0],
              2e-3f * samples.light[7].noise[0]);
  EXPECT_NEAR(samples.light[2].weight[0], 0.256f * samples.light[2].noise[0],
              1e-3f * samples.light[2].noise[0]);
  EXPECT_EQ(samples.light[5].weight[0], 0);
}

TEST(LaneSteps, APriorHoldsARoughnessThatNothingTells) {
  Samples samples = plant({0.3f, 0, 0.2f}, 8);
  for (std::size_t i = 0; i < samples.count; ++i)
    for (int k = 0; k < kLanes; ++k) samples.light[i].m[k] = 0;
  Estimate at = truthOf({0.3f, 0, 0.5f});
  Prior prior;
  for (int k = 0; k < kLanes; ++k) {
    prior.u[k] = std::log(0.4f);
    prior.u_weight[k] = 1e5f;
  }
  Equations q;
  refine(MultiLightOptions{}, samples, at, prior, q);
  EXPECT_NEAR(std::exp(at.u[3]), 0.4f, 0.02f);
}

}  // namespace
}  // namespace patina::brdf::lanes
