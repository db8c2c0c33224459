// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/reflectance_bound.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::testing {
namespace {

std::vector<brdf::LightRay> raysOf(int count) {
  std::vector<brdf::LightRay> rays;
  for (int i = 0; i < count; ++i) {
    brdf::SurfaceLight light;
    const double z = 1 - 0.7 * (i + 0.5) / count, s = std::sqrt(1 - z * z), turn = 2.4 * i;
    light.direction = {static_cast<float>(s * std::cos(turn)),
                       static_cast<float>(s * std::sin(turn)), static_cast<float>(z)};
    rays.push_back(brdf::rayAt(light, {0, 0, 1}, 0, 0));
  }
  return rays;
}

constexpr TexelExposure kExposure{27'000, 30'000, 3, 36};

TEST(ReflectanceBound, FallsWithTheRootOfThePixels) {
  const KnownTexel paint{0.2, 0.04, 0.3};
  TexelExposure four = kExposure;
  four.pixels *= 4;
  const ReflectanceBound once = boundOf(paint, raysOf(24), kExposure),
                         twice = boundOf(paint, raysOf(24), four);
  EXPECT_NEAR(once.alpha / twice.alpha, 2, 0.01);
  EXPECT_NEAR(once.specular / twice.specular, 2, 0.01);
}

TEST(ReflectanceBound, ARoughFaintLobeIsHiddenInTheDiffusePart) {
  const std::vector<brdf::LightRay> rays = raysOf(24);
  EXPECT_LT(boundOf({0.2, 0.04, 0.3}, rays, kExposure).alpha, 0.005);
  EXPECT_GT(boundOf({0.75, 0.02, 0.76}, rays, kExposure).alpha, 0.05);
}

TEST(ReflectanceBound, IsAGuessWithoutLightAndWhereAllIsClipped) {
  EXPECT_NEAR(boundOf({0.5, 0.04, 0.3}, {}, kExposure).alpha, 1 / std::sqrt(12.0), 1e-9);
  TexelExposure bright = kExposure;
  bright.white_e = 1e6;
  EXPECT_NEAR(boundOf({0.5, 0.04, 0.3}, raysOf(24), bright).diffuse, 1 / std::sqrt(12.0), 1e-9);
}

}  // namespace
}  // namespace patina::testing
