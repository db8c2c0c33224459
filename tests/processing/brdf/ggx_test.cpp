// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/ggx.h"

#include <gtest/gtest.h>

#include "processing/image/random.h"
#include "tests/processing/brdf/lobes.h"

namespace patina::brdf {
namespace {

// Uniform over the upper hemisphere.
Vec3 direction(std::uint64_t seed) {
  const double z = uniform(hashSeed(seed, 1)), phi = 2 * M_PI * uniform(hashSeed(seed, 2));
  const double s = std::sqrt(1 - z * z);
  return {static_cast<float>(s * std::cos(phi)), static_cast<float>(s * std::sin(phi)),
          static_cast<float>(z)};
}

TEST(Lambert, ReflectsExactlyItsAlbedo) {
  double sum = 0;  // of f cos over the hemisphere, midpoint rule in the polar angle
  for (int i = 0; i < 1000; ++i) {
    const double theta = (i + 0.5) / 1000 * M_PI / 2;
    sum += lambert(0.6f) * std::cos(theta) * std::sin(theta) * 2 * M_PI * (M_PI / 2 / 1000);
  }
  EXPECT_NEAR(sum, 0.6, 1e-5);
}

TEST(Ggx, DistributionProjectedOnThePlaneHasAreaOne) {
  for (const float alpha : {0.05f, 0.2f, 0.5f, 1.0f}) {
    double sum = 0;
    const int n = 200'000;
    for (int i = 0; i < n; ++i) {
      const double theta = (i + 0.5) / n * M_PI / 2;
      sum += ggxDistribution(static_cast<float>(std::cos(theta)), alpha) * std::cos(theta) *
             std::sin(theta) * 2 * M_PI * (M_PI / 2 / n);
    }
    EXPECT_NEAR(sum, 1.0, 2e-3) << "alpha " << alpha;
  }
}

TEST(Ggx, KnownValueAtNormalIncidence) {
  // l = v = n: D = 1/(pi a^2), V = 1/4, F = f0.
  const Vec3 n;
  EXPECT_NEAR(ggx(n, n, n, 0.04f, 0.5f), 0.04 / (M_PI * 0.25) / 4, 1e-6);
}

TEST(Ggx, DerivativesAreThoseOfItsValue) {
  expectDerivativesOf([](const LobeCosines& c, float r) { return ggxLobe(c, r); });
}

TEST(Ggx, LobeIsDistributionTimesVisibility) {
  EXPECT_NEAR(ggxLobe({0.6f, 0.8f, 0.95f, 0.9f}, 0.3f).value,
              ggxDistribution(0.95f, 0.3f) * smithVisibility(0.6f, 0.8f, 0.3f), 1e-5);
}

TEST(Ggx, IsReciprocal) {
  const Vec3 n;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Vec3 l = direction(2 * i), v = direction(2 * i + 1);
    const auto alpha = static_cast<float>(0.05 + 0.95 * uniform(i));
    const float there = ggx(n, l, v, 0.3f, alpha), back = ggx(n, v, l, 0.3f, alpha);
    ASSERT_NEAR(there, back, 1e-5f * std::max(1.0f, there));
  }
}

TEST(Ggx, NeverReflectsMoreThanItReceives) {
  for (const float alpha : {0.05f, 0.3f, 0.7f, 1.0f})
    for (const float n_v : {0.05f, 0.3f, 0.7f, 1.0f})
      EXPECT_LE(ggxDirectionalAlbedo(n_v, 1.0f, alpha), 1.001f) << alpha << " " << n_v;
}

TEST(Ggx, InAWhiteFurnaceASmoothMirrorDisappearsAndARoughOneLosesLittle) {
  EXPECT_NEAR(ggxDirectionalAlbedo(1.0f, 1.0f, 0.02f), 1.0, 0.002);
  EXPECT_NEAR(ggxDirectionalAlbedo(0.5f, 1.0f, 0.05f), 1.0, 0.01);
  EXPECT_GT(ggxDirectionalAlbedo(1.0f, 1.0f, 0.2f), 0.93f);
  EXPECT_GT(ggxDirectionalAlbedo(1.0f, 1.0f, 1.0f), 0.30f);  // single scattering
}

TEST(Ggx, AlbedoBySamplingAgreesWithAlbedoByPlainQuadrature) {
  const float alpha = 0.4f;
  const Vec3 n, v = normalized({0.6f, 0, 0.8f});
  double sum = 0;
  const int n_theta = 400, n_phi = 400;
  for (int i = 0; i < n_theta; ++i)
    for (int j = 0; j < n_phi; ++j) {
      const double theta = (i + 0.5) / n_theta * M_PI / 2, phi = (j + 0.5) / n_phi * 2 * M_PI;
      const Vec3 l{static_cast<float>(std::sin(theta) * std::cos(phi)),
                   static_cast<float>(std::sin(theta) * std::sin(phi)),
                   static_cast<float>(std::cos(theta))};
      sum += ggx(n, l, v, 0.8f, alpha) * l.z * std::sin(theta);
    }
  sum *= (M_PI / 2 / n_theta) * (2 * M_PI / n_phi);
  EXPECT_NEAR(ggxDirectionalAlbedo(v.z, 0.8f, alpha), sum, 0.003);
}

TEST(Ggx, LightFromBelowTheSurfaceGivesNothing) {
  const Vec3 n, below = normalized({0.5f, 0, -0.5f});
  EXPECT_EQ(ggx(n, below, n, 0.5f, 0.3f), 0.0f);
  EXPECT_EQ(ggx(n, n, below, 0.5f, 0.3f), 0.0f);
}

TEST(Schlick, IsF0InTheMiddleAndOneAtTheEdge) {
  EXPECT_FLOAT_EQ(schlickFresnel(0.04f, 1.0f), 0.04f);
  EXPECT_FLOAT_EQ(schlickFresnel(0.04f, 0.0f), 1.0f);
}

}  // namespace
}  // namespace patina::brdf
