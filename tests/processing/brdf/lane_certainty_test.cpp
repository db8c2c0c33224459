// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf::lanes {
namespace {

// Estimates from levels with noise of sigma 0.002 spread as the certainty says.
TEST(LaneCertainty, SaysTheSpreadOfKsOverManyDrawsOfNoise) {
  const Planted planted{0.3f, 0.2f, 0.3f};
  double sum = 0, square = 0, weight = 0;
  int n = 0;
  for (std::uint64_t draw = 0; draw < 12; ++draw) {
    Samples samples = plant(planted);
    for (std::size_t i = 0; i < samples.count; ++i)
      for (int k = 0; k < kLanes; ++k) {
        samples.light[i].y[k] += static_cast<float>(0.002 * gaussian(hashSeed(draw, i, k)));
        samples.light[i].noise[k] = samples.light[i].weight[k] = 1 / (0.002f * 0.002f);
      }
    Estimate at = truthOf(planted);
    Equations q;
    MultiLightOptions options;
    options.rounds = 1;
    options.steps = 8;
    refine(options, samples, at, noPrior(), q);
    for (int k = 0; k < kLanes; ++k) {
      sum += at.ks[k];
      square += at.ks[k] * at.ks[k];
      weight += certaintyOf(at, q, noPrior(), 1, k).specular_weight;
      ++n;
    }
  }
  const double sigma = std::sqrt(square / n - sum / n * (sum / n));
  EXPECT_NEAR(std::sqrt(n / weight), sigma, 0.3 * sigma);
}

TEST(LaneCertainty, IsNoneWithoutGloss) {
  Samples samples = plant({0.4f, 0, 0.3f});
  Estimate at = truthOf({0.4f, 0, 0.3f});
  Equations q;
  evaluate(Model::kGgx, samples, at, noPrior(), q);
  at.ks[3] = 0;
  EXPECT_EQ(certaintyOf(at, q, noPrior(), 1, 3).confidence, 0);
}

TEST(LaneCertainty, NeighboursMakeATexelSureButDoNotPassForItsOwnInformation) {
  Samples samples = plant({0.3f, 0.1f, 0.3f}, 8);
  for (std::size_t i = 0; i < samples.count; ++i)
    for (int k = 0; k < kLanes; ++k) samples.light[i].weight[k] = samples.light[i].noise[k] = 1e4f;
  Estimate at = truthOf({0.3f, 0.1f, 0.3f}), held = at;
  Prior prior;
  for (int k = 0; k < kLanes; ++k) {
    prior.ks[k] = 0.1f, prior.ks_weight[k] = 1e5f;
    prior.u[k] = at.u[k], prior.u_weight[k] = 1e4f;
  }
  Equations free, q;
  evaluate(Model::kGgx, samples, at, noPrior(), free);
  evaluate(Model::kGgx, samples, held, prior, q);
  const Certainty alone = certaintyOf(at, free, noPrior(), 1, 2),
                  together = certaintyOf(held, q, prior, 1, 2);
  EXPECT_GT(together.confidence, 2 * alone.confidence);
}

// What neighbours say of the strength was found with the roughness of one pool.
TEST(LaneCertainty, OfAStrengthIsNoSurerThanWhatItsRoughnessLeavesOpen) {
  Samples samples = plant({0.3f, 0.1f, 0.3f}, 8);
  for (std::size_t i = 0; i < samples.count; ++i)
    for (int k = 0; k < kLanes; ++k) samples.light[i].weight[k] = samples.light[i].noise[k] = 1e4f;
  Estimate at = truthOf({0.3f, 0.1f, 0.3f}), held = at;
  Prior prior;
  for (int k = 0; k < kLanes; ++k) prior.ks[k] = 0.1f, prior.ks_weight[k] = 1e7f;
  Equations free, q;
  evaluate(Model::kGgx, samples, at, noPrior(), free);
  evaluate(Model::kGgx, samples, held, prior, q);
  const Certainty alone = certaintyOf(at, free, noPrior(), 1, 2),
                  together = certaintyOf(held, q, prior, 1, 2);
  EXPECT_LT(together.confidence, 2 * alone.confidence);
  EXPECT_NEAR(together.specular_weight, alone.specular_weight, 0.05 * alone.specular_weight);
}

}  // namespace
}  // namespace patina::brdf::lanes
