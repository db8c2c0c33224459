// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

double cosineTo(const Estimate& a, const Estimate& b, int k) {
  return double{a.nx[k]} * b.nx[k] + double{a.ny[k]} * b.ny[k] + double{a.nz[k]} * b.nz[k];
}

TEST(LaneStart, HighlightsAndShadowsDoNotTurnTheNormal) {
  const Planted shiny{0.4f, 0.5f, 0.1f};
  Samples samples = plant(shiny);
  for (int k = 0; k < kLanes; ++k) samples.light[3].y[k] = samples.light[14].y[k] = 0.01f;
  Estimate at;
  photometricStart(samples, at);
  const Estimate truth = truthOf(shiny);
  for (int k = 0; k < kLanes; ++k) EXPECT_GT(cosineTo(at, truth, k), std::cos(6 * M_PI / 180));
}

TEST(LaneStart, CastShadowsLoseTheirWeightHighlightsKeepIt) {
  Samples samples = plant({0.4f, 0.5f, 0.1f});
  for (int k = 0; k < kLanes; ++k) samples.light[3].y[k] = 0.01f;
  Estimate at;
  photometricStart(samples, at);
  std::size_t brightest = 0;
  for (std::size_t i = 0; i < samples.count; ++i)
    if (samples.light[i].y[5] > samples.light[brightest].y[5]) brightest = i;
  EXPECT_EQ(samples.light[3].weight[5], 0);
  EXPECT_EQ(samples.light[brightest].weight[5], samples.light[brightest].noise[5]);
}

TEST(LaneStart, ATexelWithoutLightStandsUp) {
  Samples samples = plant({});
  for (std::size_t i = 0; i < samples.count; ++i) samples.light[i].noise[2] = 0;
  Estimate at;
  photometricStart(samples, at);
  EXPECT_EQ(at.nz[2], 1);
  EXPECT_EQ(at.kd[2], 0);
}

TEST(LaneStart, AMattSurfaceIsFoundAtOnce) {
  const Planted matt{0.6f, 0, 1};
  Samples samples = plant(matt);
  for (std::size_t i = 0; i < samples.count; ++i)
    for (int k = 0; k < kLanes; ++k) {
      const Estimate n = truthOf(matt);
      samples.light[i].y[k] =
          0.6f * (n.nx[k] * samples.light[i].lx[k] + n.ny[k] * samples.light[i].ly[k] +
                  n.nz[k] * samples.light[i].lz[k]);
    }
  Estimate at;
  photometricStart(samples, at);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_GT(cosineTo(at, truthOf(matt), k), 1 - 1e-5);
    EXPECT_NEAR(at.kd[k], 0.6f, 1e-3f);
  }
}

}  // namespace
}  // namespace patina::brdf::lanes
