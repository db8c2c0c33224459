// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/alike.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <utility>

namespace patina::brdf {
namespace {

using Weights = std::map<std::pair<int, int>, float>;

// Of the texel at (x, y), those above 0.
Weights weightsAt(const AlikeTexels& alike, int x, int y) {
  Weights weights;
  const int k = x % lanes::kLanes;
  alike.forEach(x - k, y, [&](int dx, int dy, const lanes::Lane& of) {
    if (of[k] > 0) weights[{x + dx, y + dy}] = of[k];
  });
  return weights;
}

TEST(AlikeTexels, AreThoseOfADiscWithinThePicture) {
  Image<float> look(37, 20, 3, 0.4f);
  MultiLightOptions options;
  options.neighbour_px = 5;
  const AlikeTexels alike(look, options);
  for (const auto& [x, y] : {std::pair{0, 0}, {36, 19}, {15, 7}, {16, 7}, {20, 2}}) {
    Weights expected;
    for (int v = 0; v < 20; ++v)
      for (int u = 0; u < 37; ++u)
        if ((u - x) * (u - x) + (v - y) * (v - y) <= 25) expected[{u, v}] = 1;
    EXPECT_EQ(weightsAt(alike, x, y), expected) << x << ", " << y;
  }
}

TEST(AlikeTexels, AreLessAlikeTheMoreColoursDiffer) {
  Image<float> look(24, 1, 1, 0.4f);
  for (int x = 0; x < 24; ++x) look.at(x, 0) = 0.4f + 0.02f * static_cast<float>(x);
  MultiLightOptions options;
  options.neighbour_px = 5;
  options.like_colour = 0.06f;
  const Weights weights = weightsAt(AlikeTexels(look, options), 10, 0);
  // 0.1 + the level between: 0.7, 0.71, ...; three units of it times 0.06 reach five texels.
  const auto expected = [](double steps, double level) {
    const double off = 0.02 * steps / (3 * 0.06 * (0.1 + level));
    return std::pow(1 - off * off, 4);
  };
  EXPECT_NEAR(weights.at({11, 0}), expected(1, 0.61), 1e-5);
  EXPECT_NEAR(weights.at({14, 0}), expected(4, 0.64), 1e-5);
  EXPECT_NEAR(weights.at({7, 0}), expected(3, 0.57), 1e-5);
}

TEST(AlikeTexels, OneOfUnknownColourIsLikeItselfAlone) {
  Image<float> look(24, 24, 3, 0.4f);
  look.at(12, 12, 1) = NAN;
  const AlikeTexels alike(look, {});
  EXPECT_EQ(weightsAt(alike, 12, 12), (Weights{{{12, 12}, 1.0f}}));
  EXPECT_FALSE(weightsAt(alike, 14, 12).contains({12, 12}));
}

TEST(AlikeTexels, OfAMosaicHaveTheSameFilter) {
  Image<float> look(24, 24, 3, 0.4f);
  MultiLightOptions options;
  options.filters = Filters{};
  options.neighbour_px = 7;
  for (const auto& [place, weight] : weightsAt(AlikeTexels(look, options), 9, 10)) {
    EXPECT_EQ(place.first % 2, 1);
    EXPECT_EQ(place.second % 2, 0);
  }
}

}  // namespace
}  // namespace patina::brdf
