// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/lane_fit.h"

#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

// Levels of `planted`, and its lobes.
Samples seen(const Planted& planted) {
  Samples samples = plant(planted);
  Estimate at = truthOf(planted);
  Equations q;
  evaluateCost(Model::kGgx, samples, at, noPrior(), q);
  return samples;
}

TEST(LaneFit, CountsWhatHasWeight) {
  const Planted planted{0.3f, 0.1f, 0.3f};
  Samples samples = seen(planted);
  samples.light[3].weight[2] = 0;
  samples.light[3].y[2] += 1;
  samples.light[5].y[2] += 0.004f;  // of a sigma of 0.001
  const LaneFit fit = fitOf(samples, truthOf(planted), 0.0f, 2);
  EXPECT_EQ(fit.used, 23);
  EXPECT_NEAR(fit.chi2, 16, 0.1);
  EXPECT_NEAR(fit.misfit(5), 16.0 / 18, 0.01);
  EXPECT_EQ(fit.spread2(5), 1);
}

TEST(LaneFit, TellsTheShareOfTheLampsNoise) {
  const Planted planted{0.4f, 0, 0.3f};
  const Samples samples = seen(planted);
  double expected = 0;
  for (const Light& light : samples.light)
    expected += std::pow(0.001 * light.y[0], 2) * light.noise[0] / 24;
  EXPECT_NEAR(fitOf(samples, truthOf(planted), 0.001f, 0).lamps, expected, 1e-3 * expected);
}

TEST(LaneFit, TwoBrighterLevelsAreAShadowsEdgeAndOneIsAGlint) {
  const Planted planted{0.3f, 0.1f, 0.3f};
  Samples samples = seen(planted);
  samples.light[4].y[1] *= 2;
  EXPECT_FALSE(isSpoilt(samples, truthOf(planted), 1));
  samples.light[9].y[1] *= 2;
  EXPECT_TRUE(isSpoilt(samples, truthOf(planted), 1));
  EXPECT_FALSE(isSpoilt(samples, truthOf(planted), 2));
}

TEST(LaneFit, WhatIsDarkerThanAnyMaterialLiesInShadow) {
  const Planted black{0.005f, 0.004f, 0.3f}, velvet{0.003f, 0.02f, 0.9f};
  EXPECT_TRUE(isSpoilt(seen(black), truthOf(black), 0));
  EXPECT_FALSE(isSpoilt(seen(velvet), truthOf(velvet), 0));
}

}  // namespace
}  // namespace patina::brdf::lanes
