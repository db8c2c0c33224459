// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/torrance_sparrow.h"

#include "tests/processing/brdf/lobes.h"

namespace patina::brdf {
namespace {

TEST(TorranceSparrow, DerivativesAreThoseOfItsValue) {
  expectDerivativesOf([](const LobeCosines& c, float r) { return torranceSparrowLobe(c, r); });
}

TEST(TorranceSparrow, NormIsTheProjectedAreaOfTheGaussianOfTheSine) {
  for (const float sigma : {0.05f, 0.2f, 0.6f, 1.0f, 2.0f}) {
    double sum = 0;
    const int n = 100'000;
    for (int i = 0; i < n; ++i) {
      const double theta = (i + 0.5) / n * M_PI / 2, s = std::sin(theta);
      sum += std::exp(-s * s / (double{sigma} * sigma)) * std::cos(theta) * s;
    }
    sum *= 2 * M_PI * (M_PI / 2 / n);
    EXPECT_NEAR(torranceSparrowNorm(sigma), sum, 1e-5 * sum) << sigma;
  }
}

TEST(TorranceSparrow, IsReciprocal) {
  expectReciprocal([](const LobeCosines& c, float r) { return torranceSparrowLobe(c, r); });
}

TEST(TorranceSparrow, IsHighestAtTheMirrorDirection) {
  EXPECT_GT(torranceSparrowLobe({0.8f, 0.8f, 1, 0.8f}, 0.2f).value,
            torranceSparrowLobe({0.8f, 0.8f, 0.95f, 0.8f}, 0.2f).value);
}

TEST(TorranceSparrow, ANarrowLobeReflectsItsDecoupledStrength) {
  const double albedo = directionalAlbedo(0.8, [](const LobeCosines& c, double) {
    return double{torranceSparrowLobe(c, 0.05f).value};
  });
  // F = G = 1: the half vectors' projected area times 4 (v.h) (n.l) / (4 (n.l) (n.v)), v.h near
  // n.v.
  EXPECT_NEAR(albedo, 1, 0.01);
}

TEST(TorranceSparrow, ReflectsNoMoreThanItReceivesButAtGrazingAngles) {
  const auto albedo = [](double n_v, float sigma) {
    return directionalAlbedo(n_v, [&](const LobeCosines& c, double) {
      return double{torranceSparrowLobe(c, sigma).value};
    });
  };
  for (const float sigma : {0.05f, 0.2f, 0.5f, 1.0f})
    for (const double n_v : {0.5, 0.7, 1.0}) EXPECT_LE(albedo(n_v, sigma), 1.001) << sigma;
  EXPECT_GT(albedo(0.05, 0.5f), 2);  // as its header warns
}

}  // namespace
}  // namespace patina::brdf
