// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

TEST(LaneEquations, AtTheTruthTheLinearPartIsTheTruthAndNothingIsLeft) {
  Samples samples = plant({});
  Estimate at = truthOf({});
  for (int k = 0; k < kLanes; ++k) at.kd[k] = at.ks[k] = 0;
  Equations q;
  evaluate(Model::kGgx, samples, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(at.kd[k], 0.4f, 1e-4f);
    EXPECT_NEAR(at.ks[k], 0.1f, 1e-4f);
    EXPECT_LT(q.cost[k], 0.1f);  // 24 levels of weight 1e6: 6e-5 each
  }
}

// The slope of the cost with kd and ks solved inside is -2 b (Golub and Pereyra 1973).
TEST(LaneEquations, SlopesAreThoseOfTheProjectedCost) {
  Samples samples = plant({});
  Estimate at = truthOf({});
  for (int k = 0; k < kLanes; ++k) {
    const Vec3 n = normalized({at.nx[k] + 0.05f, at.ny[k] - 0.03f, at.nz[k]});
    at.nx[k] = n.x, at.ny[k] = n.y, at.nz[k] = n.z;
    at.u[k] += 0.3f;
  }
  Equations q, up, down;
  const Tangents t = tangentsOf(at);
  evaluate(Model::kGgx, samples, at, noPrior(), q);
  const auto moved = [&](float d1, float d2, float du) {
    Estimate to = at;
    for (int k = 0; k < kLanes; ++k) {
      const Vec3 n = normalized({at.nx[k] + d1 * t.x1[k] + d2 * t.x2[k], at.ny[k] + d2 * t.y2[k],
                                 at.nz[k] + d1 * t.z1[k] + d2 * t.z2[k]});
      to.nx[k] = n.x, to.ny[k] = n.y, to.nz[k] = n.z;
      to.u[k] = at.u[k] + du;
    }
    return to;
  };
  const float h = 2e-3f;
  const auto check = [&](const Lane& b, float d1, float d2, float du) {
    Estimate high = moved(d1, d2, du), low = moved(-d1, -d2, -du);
    evaluateCost(Model::kGgx, samples, high, noPrior(), up);
    evaluateCost(Model::kGgx, samples, low, noPrior(), down);
    for (int k = 0; k < kLanes; ++k) {
      const float slope = (up.cost[k] - down.cost[k]) / (2 * h);
      EXPECT_NEAR(-2 * b[k], slope, 0.03f * std::abs(slope) + 0.01f * q.cost[k]) << k;
    }
  };
  check(q.b1, h, 0, 0);
  check(q.b2, 0, h, 0);
  check(q.bu, 0, 0, h);
}

TEST(LaneEquations, NothingIsBelowZero) {
  float kd = -1, ks = -1;
  solveLinear(2, 1, 2, -1, 3, kd, ks);  // the plain solution has kd = -5/3
  EXPECT_EQ(kd, 0);
  EXPECT_FLOAT_EQ(ks, 1.5f);
  solveLinear(2, 1, 2, 3, -1, kd, ks);
  EXPECT_FLOAT_EQ(kd, 1.5f);
  EXPECT_EQ(ks, 0);
  solveLinear(2, 0, 0, 3, 0, kd, ks);  // no gloss in any light
  EXPECT_FLOAT_EQ(kd, 1.5f);
  EXPECT_EQ(ks, 0);
}

TEST(LaneEquations, TangentsAreUnitAndAcrossTheNormal) {
  const Estimate at = truthOf({});
  const Tangents t = tangentsOf(at);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(t.x1[k] * at.nx[k] + t.z1[k] * at.nz[k], 0, 1e-6);
    EXPECT_NEAR(t.x2[k] * at.nx[k] + t.y2[k] * at.ny[k] + t.z2[k] * at.nz[k], 0, 1e-6);
    EXPECT_NEAR(t.x2[k] * t.x2[k] + t.y2[k] * t.y2[k] + t.z2[k] * t.z2[k], 1, 1e-5);
  }
}

}  // namespace
}  // namespace patina::brdf::lanes
