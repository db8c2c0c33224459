// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

Estimate started(Samples& s, Equations& q) {
  Estimate at;
  photometricStart(s, at);
  scanRoughness(Model::kGgx, s, at, noPrior());
  refine({}, s, at, noPrior(), q);
  return at;
}

// Lamps below 45 degrees and every fourth above do not get in: most of them.
void shade(Samples& s) {
  for (std::size_t i = 0; i < s.count; ++i)
    for (int k = 0; k < kLanes; ++k)
      if (s.light[i].lz[k] < 0.71f || i % 4 == 0) s.light[i].y[k] = 0;
}

TEST(LaneRivals, FindWhatMostLampsDoNotReach) {
  const Planted matt{0.5f, 0.04f, 0.8f};
  Samples s = plant(matt, 32);
  shade(s);
  Equations q;
  Estimate at = started(s, q);
  EXPECT_GT(std::abs(at.kd[3] - 0.5f), 0.05f);  // middle levels are dark ones
  tryRivals({}, s, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(at.kd[k], 0.5f, 0.02f) << k;
    EXPECT_NEAR(at.nx[k], truthOf(matt).nx[k], 0.02f) << k;
    EXPECT_EQ(s.shadowed[k], 1) << k;
  }
}

// What later passes go by: where half of the levels are dark, their median says nothing.
TEST(LaneRivals, SayThatHalfOfTheLampsDoNotReach) {
  Samples s = plant({0.5f, 0.04f, 0.8f}, 32);
  for (std::size_t i = 0; i < s.count; i += 2) s.light[i].y = Lane{};
  Equations q;
  Estimate at = started(s, q);
  tryRivals({}, s, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(at.kd[k], 0.5f, 0.02f) << k;
    EXPECT_EQ(s.shadowed[k], 1) << k;
  }
}

TEST(LaneRivals, LeaveWhatIsMetAsItIs) {
  Samples s = plant({0.4f, 0.1f, 0.25f});
  Equations q;
  Estimate at = started(s, q);
  const Estimate before = at;
  tryRivals({}, s, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_EQ(at.kd[k], before.kd[k]);
    EXPECT_EQ(at.u[k], before.u[k]);
    EXPECT_EQ(s.shadowed[k], 0);
  }
}

// A metal begun as a matt surface that leans: from where its highlights are it stands up.
TEST(LaneRivals, BeginAMetalWhereItsHighlightsAre) {
  const Planted metal{0.05f, 0.55f, 0.34f};
  Samples s = plant(metal);
  Equations q;
  Estimate at;
  for (int k = 0; k < kLanes; ++k) {
    at.nx[k] = -0.6f, at.ny[k] = 0.5f, at.nz[k] = 0.62f;
    at.u[k] = std::log(0.9f);
  }
  evaluate(Model::kGgx, s, at, noPrior(), q);
  tryRivals({}, s, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    EXPECT_NEAR(at.ks[k], 0.55f, 0.02f) << k;
    EXPECT_NEAR(at.kd[k], 0.05f, 0.02f) << k;
    EXPECT_EQ(s.shadowed[k], 0) << k;
  }
}

// Three levels are met by anything: a few lit lamps are no reason to take all others for shadow.
TEST(LaneRivals, AreNotBelievedOnFourLevels) {
  Samples s = plant({0.5f, 0.04f, 0.8f});
  for (std::size_t i = 4; i < s.count; ++i)
    for (int k = 0; k < kLanes; ++k) s.light[i].y[k] = 0.01f * static_cast<float>(i % 3);
  Equations q;
  Estimate at = started(s, q);
  tryRivals({}, s, at, noPrior(), q);
  for (int k = 0; k < kLanes; ++k) {
    int lit = 0;
    for (std::size_t i = 0; i < s.count; ++i) lit += s.light[i].weight[k] > 0;
    EXPECT_GE(lit, kFewestLit) << k;
  }
}

}  // namespace
}  // namespace patina::brdf::lanes
