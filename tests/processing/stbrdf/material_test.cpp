// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace patina::stbrdf {
namespace {

// Diffuse rises from 0.2 to 0.8, the normal turns from straight up towards x, encoded in [0,1].
StbrdfSet rising() {
  StbrdfSet set{.degree = 1, .maps = {}, .facts = {}};
  TimeMap diffuse{.name = "Diffuse", .coefficients = {}},
      roughness{.name = "Roughness", .coefficients = {}},
      normal{.name = "Normal", .coefficients = {}}, height{.name = "Height", .coefficients = {}};
  diffuse.coefficients = {Image<float>(3, 2, 3, 0.2f), Image<float>(3, 2, 3, 0.6f)};
  roughness.coefficients = {Image<float>(3, 2, 3, 0.5f), Image<float>(3, 2, 3, 0.0f)};
  normal.coefficients = {Image<float>(3, 2, 3, 0.5f), Image<float>(3, 2, 3, 0.0f)};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 3; ++x) {
      normal.coefficients[0].at(x, y, 2) = 1;
      normal.coefficients[1].at(x, y, 0) = 0.5f;
    }
  height.coefficients = {Image<float>(3, 2, 1, 0.1f), Image<float>(3, 2, 1, 0.4f)};
  set.maps = {diffuse, roughness, normal, height};
  set.facts.number("mm_per_texel", 0.25);
  return set;
}

TEST(MaterialAt, GivesMapsThatCanBeLit) {
  const Material m = materialAt(rising(), {0.5, {}, {}});
  EXPECT_FLOAT_EQ(m.maps.diffuse.at(2, 1, 1), 0.5f);
  EXPECT_EQ(m.maps.roughness.channels(), 1);
  EXPECT_NEAR(m.maps.normal.at(0, 0, 0), 0.5 / std::hypot(0.5, 1), 1e-6);
  EXPECT_NEAR(m.maps.normal.at(0, 0, 2), 1 / std::hypot(0.5, 1), 1e-6);
  EXPECT_FLOAT_EQ(m.maps.extra.at("Height").at(1, 1), 0.3f);
  EXPECT_EQ(m.info.facts.number("mm_per_texel"), 0.25);
  EXPECT_EQ(m.info.facts.number("time"), 0.5);
}

TEST(MaterialAt, GivesEveryTexelItsOwnTime) {
  LocalTime local{0.5, Image<float>(3, 2, 1, 1), Image<float>(3, 2, 1, 0)};
  local.rate.at(0, 0) = 0;
  local.rate.at(1, 0) = 0.5f;
  local.start.at(2, 0) = 0.25f;
  local.start.at(2, 1) = -3;
  local.rate.at(1, 1) = 9;
  const Material m = materialAt(rising(), local);
  const auto at = [&](int x, int y) { return m.maps.diffuse.at(x, y, 0); };
  EXPECT_FLOAT_EQ(at(0, 0), 0.2f);
  EXPECT_FLOAT_EQ(at(1, 0), 0.35f);
  EXPECT_FLOAT_EQ(at(2, 0), 0.65f);
  EXPECT_FLOAT_EQ(at(0, 1), 0.5f);
  EXPECT_FLOAT_EQ(at(1, 1), 0.8f);
  EXPECT_FLOAT_EQ(at(2, 1), 0.2f);
}

TEST(MaterialAt, WithOneTimeForAllIsThatOfNoMap) {
  const Material plain = materialAt(rising(), {0.3, {}, {}});
  const Material mapped = materialAt(rising(), {0.3, Image<float>(3, 2, 1, 1), {}});
  for (std::size_t i = 0; i < plain.maps.diffuse.texels().size(); ++i)
    EXPECT_NEAR(plain.maps.diffuse.texels()[i], mapped.maps.diffuse.texels()[i], 1e-7);
}

TEST(MaterialAt, RefusesMapsOfAnotherSizeAndRatesThatGoBack) {
  EXPECT_THROW(materialAt(rising(), {0.5, Image<float>(2, 2, 1, 1), {}}), ProcessingError);
  EXPECT_THROW(materialAt(rising(), {0.5, Image<float>(3, 2, 1, -0.1f), {}}), ProcessingError);
  EXPECT_THROW(
      materialAt(rising(),
                 {0.5, Image<float>(3, 2, 1, std::numeric_limits<float>::quiet_NaN()), {}}),
      ProcessingError);
}

}  // namespace
}  // namespace patina::stbrdf
