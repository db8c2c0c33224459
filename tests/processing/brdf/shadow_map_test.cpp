// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/shadow_map.h"

#include <gtest/gtest.h>

#include <set>
#include <utility>

#include "tests/processing/brdf/lane_samples.h"

namespace patina::brdf {
namespace {

using lanes::kLanes;
using lanes::Samples;
using Place = std::pair<int, int>;
constexpr SizePx kSize{20, 4};

// Of `lamp` at (5, 2).
ShadowMap withShadowOf(std::size_t lamp, std::size_t lamps) {
  ShadowMap map(kSize, lamps);
  for (int y = 0; y < kSize.height; ++y)
    for (int x0 = 0; x0 < kSize.width; x0 += kLanes) {
      Samples samples = lanes::plant({}, static_cast<int>(lamps));
      if (y == 2 && x0 == 0) samples.light[lamp].weight[5] = 0;
      map.keep(samples, x0, y);
    }
  return map;
}

std::set<Place> forgotten(const ShadowMap& map, std::size_t lamp, const Samples& samples) {
  std::set<Place> places;
  for (int y = 0; y < kSize.height; ++y)
    for (int x0 = 0; x0 < kSize.width; x0 += kLanes) {
      Samples left = samples;
      map.forgetEdges(left, x0, y);
      for (int k = 0; k < kLanes && x0 + k < kSize.width; ++k)
        if (!(left.light[lamp].noise[k] > 0)) places.insert({x0 + k, y});
    }
  return places;
}

TEST(ShadowMap, LevelsBesideAShadowAreForgottenOfThatLampAlone) {
  const std::set<Place> around{{4, 1}, {5, 1}, {6, 1}, {4, 2}, {6, 2}, {4, 3}, {5, 3}, {6, 3}};
  for (const std::size_t lamp : {std::size_t{3}, std::size_t{31}, std::size_t{33}}) {
    const ShadowMap map = withShadowOf(lamp, 40);
    EXPECT_EQ(forgotten(map, lamp, lanes::plant({}, 40)), around) << lamp;
    EXPECT_TRUE(forgotten(map, lamp - 1, lanes::plant({}, 40)).empty()) << lamp;
  }
}

TEST(ShadowMap, FewLevelsAreNotMadeFewer) {
  const ShadowMap map = withShadowOf(3, 24);
  Samples samples = lanes::plant({});
  for (std::size_t i = 6; i < 24; ++i) samples.light[i].noise = {};
  EXPECT_TRUE(forgotten(map, 3, samples).empty());
  samples.light[7].noise = samples.light[0].noise;
  EXPECT_EQ(forgotten(map, 3, samples).size(), 8u);
}

TEST(ShadowMap, WhatIsNotKnownCastsNoShadow) {
  ShadowMap map(kSize, 24);
  Samples samples = lanes::plant({});
  samples.light[3].noise[5] = samples.light[3].weight[5] = 0;
  map.keep(samples, 0, 2);
  Samples left = lanes::plant({});
  map.forgetEdges(left, 0, 1);
  EXPECT_GT(left.light[3].noise[5], 0);
}

}  // namespace
}  // namespace patina::brdf
