// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <random>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

TEST(LaneCurve, IsLeastAtTheTruth) {
  const Planted planted{0.3f, 0.2f, 0.3f};
  Samples samples = plant(planted);
  CostCurve curve;
  costCurve(Model::kGgx, samples, truthOf(planted), curve);
  int least = 0;
  for (int j = 1; j < kCurve; ++j)
    if (curve.cost[j][7] < curve.cost[least][7]) least = j;
  EXPECT_NEAR(curveLogR(least), std::log(0.3f), 0.08f);
  EXPECT_NEAR(curve.ks[least][7], 0.2f, 0.03f);
  EXPECT_LT(curve.slope[least - 1][7], 0);
  EXPECT_GT(curve.slope[least + 1][7], 0);
}

// A normal that another roughness went with does not make its own roughness the likeliest.
TEST(LaneCurve, TurnsTheNormalAlong) {
  const Planted planted{0.3f, 0.2f, 0.3f};
  Samples samples = plant(planted);
  Estimate at = truthOf(planted);
  const auto costAt = [&](const Estimate& from) {
    CostCurve curve;
    costCurve(Model::kGgx, samples, from, curve);
    int least = 0;
    for (int j = 1; j < kCurve; ++j)
      if (curve.cost[j][3] < curve.cost[least][3]) least = j;
    return curve.cost[least][3];
  };
  const float known = costAt(at);
  for (int k = 0; k < kLanes; ++k) {
    at.nx[k] += 0.01f;
    at.nz[k] = std::sqrt(1 - at.nx[k] * at.nx[k] - at.ny[k] * at.ny[k]);
  }
  Estimate fixed = at;
  Equations q;
  for (int k = 0; k < kLanes; ++k) fixed.u[k] = std::log(0.3f);
  evaluate(Model::kGgx, samples, fixed, noPrior(), q);
  EXPECT_LT(costAt(at), known + 0.05f * q.cost[3]);
}

// Strengths that could not be negative would be too large on average where noise is larger than
// they are, and costs too low where they are least known.
TEST(LaneCurve, StrengthsHaveEitherSignAndTheirVariance) {
  const Planted planted{0.3f, 0.02f, 0.3f};
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  double mean = 0, scatter = 0, count = 0;
  int below = 0, entry = 0;
  while (curveLogR(entry) < std::log(planted.r)) ++entry;
  for (int tile = 0; tile < 60; ++tile) {
    Samples samples = plant(planted);
    for (Light& light : samples.light)
      for (int k = 0; k < kLanes; ++k) {
        light.noise[k] = light.weight[k] = 1 / (0.05f * 0.05f);
        light.y[k] += 0.05f * normal(random);
      }
    CostCurve curve;
    costCurve(Model::kGgx, samples, truthOf(planted), curve);
    for (int k = 0; k < kLanes; ++k, ++count) {
      const double off = curve.ks[entry][k] - planted.ks;
      mean += off;
      scatter += off * off * curve.information[entry][k];
      below += curve.ks[entry][k] < 0;
    }
  }
  EXPECT_GT(below, 0.1 * count);
  EXPECT_NEAR(mean / count, 0, 0.003);
  EXPECT_NEAR(scatter / count, 1, 0.15);
}

}  // namespace
}  // namespace patina::brdf::lanes
