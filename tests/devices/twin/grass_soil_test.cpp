// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grass_soil.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

namespace patina::devices::twin {
namespace {

void everywhere(const std::function<void(const Soil&)>& look, float texel_mm = 0.1f) {
  const GrassSoil ground(5);
  for (float y = -40; y < 40; y += 0.8f)
    for (float x = -40; x < 40; x += 0.8f) look(ground.at(x, y, texel_mm));
}

TEST(GrassSoil, IsDarkAndBrown) {
  double r = 0, b = 0, count = 0;
  everywhere([&](const Soil& soil) {
    EXPECT_GE(std::min({soil.albedo.r, soil.albedo.g, soil.albedo.b}), 0);
    if (soil.seed > 0) return;
    r += soil.albedo.r;
    b += soil.albedo.b;
    ++count;
  });
  EXPECT_LT(r / count, 0.08);
  EXPECT_GT(r, 1.8 * b);
}

TEST(GrassSoil, GrainsOfSeedAreFewLightAndStandOutOfIt) {
  double grains = 0, count = 0, light = 0, grain_mm = 0, soil_mm = 0;
  everywhere([&](const Soil& soil) {
    ++count;
    soil_mm += soil.relief;
    if (soil.seed < 0.9f) return;
    ++grains;
    light += soil.albedo.r;
    grain_mm += soil.relief;
  });
  EXPECT_GT(grains / count, 0.01);
  EXPECT_LT(grains / count, 0.12);
  EXPECT_GT(light / grains, 0.15);
  EXPECT_GT(grain_mm / grains, soil_mm / count);
}

TEST(GrassSoil, LosesItsCrumbsInACoarseTexelButNotItsHeight) {
  const auto spreadAndMean = [](float texel_mm) {
    double sum = 0, squares = 0, count = 0;
    everywhere(
        [&](const Soil& soil) {
          sum += soil.relief;
          squares += soil.relief * soil.relief;
          ++count;
        },
        texel_mm);
    return std::pair(std::sqrt(squares / count - sum * sum / count / count), sum / count);
  };
  const auto [fine, fine_mean] = spreadAndMean(0.1f);
  const auto [coarse, coarse_mean] = spreadAndMean(4);
  EXPECT_LT(coarse, 0.6 * fine);
  EXPECT_NEAR(coarse_mean, fine_mean, 0.3);
}

}  // namespace
}  // namespace patina::devices::twin
