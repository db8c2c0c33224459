// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/relight.h"

#include <gtest/gtest.h>

#include "processing/brdf/ggx.h"
#include "processing/brdf/ward.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

TEST(Relight, AWhiteDiffuserThatFacesTheLightIsOne) {
  BrdfMaps maps;
  maps.diffuse = Image<float>(2, 2, 3, 1.0f);
  BrdfSetInfo info;
  info.model = Model::kLambert;
  SurfaceLight light;
  EXPECT_FLOAT_EQ(relight(maps, info, light).at(1, 1, 2), 1);
  light.direction = normalized({1, 0, 1});
  EXPECT_FLOAT_EQ(relight(maps, info, light).at(0, 0), std::sqrt(0.5f));
}

TEST(Relight, IsTheModelsOwnValue) {
  const BrdfMaps maps = rollingMaps(6, 5, {0.2f, 0.3f});
  SurfaceLight light;
  light.direction = normalized({0.4f, -0.3f, 0.8f});
  const auto n = maps.normal.view().texel(4, 3);
  const Vec3 normal{n[0], n[1], n[2]};
  const float want =
      (maps.diffuse.at(4, 3, 1) + kPi * ggx(normal, light.direction, {0, 0, 1}, 0.2f, 0.3f)) *
      dot(normal, light.direction);
  EXPECT_NEAR(relight(maps, {}, light).at(4, 3, 1), want, 1e-5);
}

TEST(Relight, PerceptualRoughnessIsSquared) {
  BrdfMaps alpha = rollingMaps(4, 4, {0.2f, 0.25f}), perceptual = rollingMaps(4, 4, {0.2f, 0.5f});
  BrdfSetInfo info;
  info.roughness = RoughnessKind::kPerceptual;
  EXPECT_FLOAT_EQ(relight(alpha, {}, {}).at(2, 2), relight(perceptual, info, {}).at(2, 2));
}

TEST(Relight, ANearLampFallsOffWithTheSquareOfTheDistance) {
  BrdfMaps maps;
  maps.diffuse = Image<float>(1, 1, 1, 1.0f);
  BrdfSetInfo info;
  info.model = Model::kLambert;
  SurfaceLight lamp;
  lamp.near = true;
  lamp.position_mm = {0, 0, 20};
  lamp.strength = 100;
  EXPECT_FLOAT_EQ(relight(maps, info, lamp).at(0, 0), 100.0f / 400);
}

TEST(Relight, TurnedFromTheLightIsBlack) {
  BrdfMaps maps = rollingMaps(2, 2, {0.2f, 0.3f});
  SurfaceLight light;
  light.direction = normalized({1, 0, 0.01f});
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 2; ++x) {
      const auto n = maps.normal.view().texel(x, y);
      n[0] = -0.6f, n[1] = 0, n[2] = 0.8f;
    }
  EXPECT_EQ(relight(maps, {}, light).at(1, 0), 0);
}

TEST(Relight, AnisotropicHighlightsStretchAlongTheRougherTangent) {
  BrdfMaps maps = rollingMaps(1, 1, {0.2f, 0.5f});
  const auto n = maps.normal.view().texel(0, 0);
  n[0] = n[1] = 0, n[2] = 1;
  maps.extra["RoughnessY"] = Image<float>(1, 1, 1, 0.1f);
  maps.extra["Tangent"] = Image<float>(1, 1, 3);
  maps.extra["Tangent"].at(0, 0, 0) = 1;
  BrdfSetInfo info;
  info.model = Model::kWardAnisotropic;
  SurfaceLight along, across;
  along.direction = normalized({0.5f, 0, 1});
  across.direction = normalized({0, 0.5f, 1});
  EXPECT_GT(relight(maps, info, along).at(0, 0), relight(maps, info, across).at(0, 0) + 0.05f);
}

}  // namespace
}  // namespace patina::brdf
