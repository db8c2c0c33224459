// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/light_residual.h"

#include <gtest/gtest.h>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

// Smooth in the light, different at every texel.
float planted(const Vec3& l, int x, int y) {
  return 0.1f * std::sin(3 * l.x + 0.3f * static_cast<float>(x)) +
         0.05f * l.y * static_cast<float>(y);
}

LightResidual fitOf(int lights) {
  std::vector<Image<float>> off;
  std::vector<Vec3> at;
  for (const SurfaceLight& light : dome(lights)) {
    Image<float> picture(9, 7, 1);
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 9; ++x) picture.at(x, y) = planted(light.direction, x, y);
    off.push_back(std::move(picture));
    at.push_back(light.direction);
  }
  Progress progress;
  return fitResidual(std::move(off), std::move(at), progress);
}

TEST(LightResidual, IsMetBetweenTheLights) {
  const LightResidual residual = fitOf(40);
  for (const Vec3& l : {normalized({0.2f, 0.3f, 0.9f}), normalized({-0.4f, 0.1f, 0.8f})}) {
    const Image<float> got = residualUnder(residual, l);
    for (int y = 0; y < 7; ++y)
      for (int x = 0; x < 9; ++x) EXPECT_NEAR(got.at(x, y), planted(l, x, y), 0.01f);
  }
}

TEST(LightResidual, TellsItsErrorWithoutThePictureAtHand) {
  const LightResidual many = fitOf(60), few = fitOf(12);
  EXPECT_LT(many.leave_one_out_rms, 0.01);
  EXPECT_GT(few.leave_one_out_rms, many.leave_one_out_rms);
}

TEST(LightResidual, FarFromAllLightsNothingIsAdded) {
  LightResidual residual = fitOf(40);
  residual.width = 0.05;
  EXPECT_NEAR(residualUnder(residual, {0, 0, -1}).at(4, 4), 0, 1e-6f);
}

}  // namespace
}  // namespace patina::brdf
