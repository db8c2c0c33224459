// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/abc.h"

#include <gtest/gtest.h>

#include "processing/brdf/ggx.h"
#include "processing/image/random.h"

namespace patina::brdf {
namespace {

// Fits of the MERL materials fruitwood-241, special-walnut-224 and nickel.
const AbcLobe kFruitwood{{5.976665f, 5.760932f, 5.568172f}, 192.199890f, 1.573300f, 1.483582f};
const AbcLobe kWalnut{{0.704096f, 0.693490f, 0.676845f}, 15.779606f, 2.668091f, 1.883156f};
const AbcLobe kNickel{{36.614742f, 32.745403f, 28.906111f}, 705.733887f, 1.945258f, 5.441883f};

// Uniform over the upper hemisphere, not closer to the horizon than 3 degrees.
Vec3 direction(std::uint64_t seed) {
  const double z = 0.05 + 0.95 * uniform(hashSeed(seed, 1)),
               phi = 2 * M_PI * uniform(hashSeed(seed, 2)), s = std::sqrt(1 - z * z);
  return {static_cast<float>(s * std::cos(phi)), static_cast<float>(s * std::sin(phi)),
          static_cast<float>(z)};
}

TEST(Abc, InlinePowersAgreeWithTheLibrary) {
  for (int i = 0; i < 2000; ++i) {
    const double v = std::exp2(-20 + 40.0 * i / 1999);
    ASSERT_NEAR(log2Inline(static_cast<float>(v)), std::log2(double{static_cast<float>(v)}), 3e-6);
    const auto x = static_cast<float>(-60 + 120.0 * i / 1999);
    ASSERT_NEAR(exp2Inline(x) / std::exp2(double{x}), 1, 3e-7) << x;
  }
  EXPECT_EQ(log2Inline(1), 0.0f);
  EXPECT_EQ(exp2Inline(0), 1.0f);
}

TEST(Abc, KnownValueAtNormalIncidence) {
  // h = n: D = A, G = 1, F = ((ior - 1) / (ior + 1))^2.
  const Vec3 n;
  const double f = std::pow((1.883156 - 1) / (1.883156 + 1), 2);
  EXPECT_NEAR(abc(kWalnut, 0, n, n, n), f * 0.704096 / M_PI, 1e-7);
  EXPECT_NEAR(abc(kWalnut, 2, n, n, n), f * 0.676845 / M_PI, 1e-7);
}

TEST(Abc, AgreesWithItsEvaluationInDoublePrecision) {
  const Vec3 n;
  for (const AbcLobe& lobe : {kFruitwood, kWalnut, kNickel})
    for (std::uint64_t i = 0; i < 3000; ++i) {
      const Vec3 l = direction(2 * i), v = direction(2 * i + 1), h = halfway(l, v);
      const double exact = abcExact(lobe, 1, dot(n, h), dot(n, l), dot(n, v), dot(v, h));
      ASSERT_NEAR(abc(lobe, 1, n, l, v) / exact, 1, 1e-5) << i;
    }
}

TEST(Abc, IsReciprocal) {
  const Vec3 n;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const Vec3 l = direction(2 * i), v = direction(2 * i + 1);
    const float there = abc(kFruitwood, 0, n, l, v), back = abc(kFruitwood, 0, n, v, l);
    ASSERT_NEAR(there, back, 1e-5f * there);
  }
}

TEST(Abc, AlbedoByHalfVectorsAgreesWithPlainQuadrature) {
  const Vec3 n, v = normalized({0.6f, 0, 0.8f});
  double sum = 0;
  const int n_theta = 400, n_phi = 400;
  for (int i = 0; i < n_theta; ++i)
    for (int j = 0; j < n_phi; ++j) {
      const double theta = (i + 0.5) / n_theta * M_PI / 2, phi = (j + 0.5) / n_phi * 2 * M_PI;
      const Vec3 l{static_cast<float>(std::sin(theta) * std::cos(phi)),
                   static_cast<float>(std::sin(theta) * std::sin(phi)),
                   static_cast<float>(std::cos(theta))};
      sum += abc(kFruitwood, 0, n, l, v) * l.z * std::sin(theta);
    }
  sum *= (M_PI / 2 / n_theta) * (2 * M_PI / n_phi);
  EXPECT_NEAR(abcDirectionalAlbedo(kFruitwood, 0, v.z) / sum, 1, 0.003);
}

// A mirror whose lobe is normalised, (B, C) -> narrow, of index -> infinity, gives all light back.
TEST(Abc, InAWhiteFurnaceANormalisedNarrowLobeDisappears) {
  AbcLobe mirror{{0, 0, 0}, 1e5f, 3, 1e6f};
  mirror.a[0] = mirror.b * (mirror.c - 1) / 8;  // the area 4 D / pi projects on the plane is 1
  EXPECT_NEAR(abcDirectionalAlbedo(mirror, 0, 1.0, 256), 1, 0.01);
  EXPECT_NEAR(abcDirectionalAlbedo(mirror, 0, 0.5, 256), 1, 0.01);
}

TEST(Abc, LightFromBelowTheSurfaceGivesNothing) {
  const Vec3 n, below = normalized({0.5f, 0, -0.5f});
  EXPECT_EQ(abc(kWalnut, 0, n, below, n), 0.0f);
  EXPECT_EQ(abc(kWalnut, 0, n, n, below), 0.0f);
}

TEST(Abc, StaysFiniteForCosinesClampedAtZero) {
  for (const float n_h : {0.0f, 0.5f})
    for (const float n_v : {0.0f, 0.7f})
      for (const float v_h : {0.0f, 0.5f}) {
        const float f = abcShape(kFruitwood, n_h, 0, n_v, v_h);
        ASSERT_TRUE(std::isfinite(f)) << n_h << " " << n_v << " " << v_h;
        ASSERT_GE(f, 0);
      }
}

TEST(Abc, ItsNearestGgxHasItsHeightAndItsWidth) {
  const GgxEquivalent near = nearestGgx(kWalnut);
  const Vec3 n;
  EXPECT_NEAR(ggx(n, n, n, near.f0[0], near.alpha) / abc(kWalnut, 0, n, n, n), 1, 1e-4);
  const double half_angle = std::acos(1 - (std::exp2(1 / double{kWalnut.c}) - 1) / kWalnut.b);
  const auto n_h = static_cast<float>(std::cos(half_angle));
  EXPECT_NEAR(abcFalloff(kWalnut, n_h), 0.5, 1e-5);
  EXPECT_NEAR(ggxDistribution(n_h, near.alpha) / ggxDistribution(1, near.alpha), 0.5, 1e-4);
}

TEST(Fresnel, IsKnownHeadOnAndOneAtTheEdge) {
  EXPECT_NEAR(dielectricFresnel(1, 1.5f), 0.04, 1e-6);
  EXPECT_NEAR(dielectricFresnel(0, 1.5f), 1, 1e-6);
}

}  // namespace
}  // namespace patina::brdf
