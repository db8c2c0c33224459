// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/height_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace patina::mesh {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

// x, y in mm from the middle, y up.
Image<float> heights(SizePx size, double mm_per_texel,
                     const std::function<double(double, double)>& f) {
  Image<float> out(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out.at(x, y) = static_cast<float>(f((x + 0.5 - size.width / 2.0) * mm_per_texel,
                                          (size.height / 2.0 - y - 0.5) * mm_per_texel));
  return out;
}

HeightMap mapOf(const Image<float>& h, double mm_per_texel) { return {h.view(), mm_per_texel}; }

TEST(HeightMap, OfARampLeansByItsAngleWithTheNormalAwayFromTheRise) {
  const double rise = std::tan(30 * kDegree);
  const Image<float> h = heights({20, 16}, 0.5, [&](double, double y) { return rise * y; });
  const HeightMap map = mapOf(h, 0.5);
  const Image<float> slope = slopeOf(map), n = normalsOf(map);
  for (int y = 0; y < 16; ++y) {
    EXPECT_NEAR(slope.at(9, y), 30, 1e-3);
    EXPECT_NEAR(n.at(9, y, 1), -0.5, 1e-5);
    EXPECT_NEAR(n.at(9, y, 2), std::cos(30 * kDegree), 1e-5);
  }
}

TEST(HeightMap, OfASphereHasOneOverItsRadiusForMeanCurvature) {
  const Image<float> h =
      heights({81, 81}, 0.05, [](double x, double y) { return std::sqrt(100 - x * x - y * y); });
  const Image<float> curvature = meanCurvatureOf(mapOf(h, 0.05));
  for (int i = 8; i < 73; i += 8) EXPECT_NEAR(curvature.at(i, 40), 0.1, 2e-3) << i;
}

TEST(HeightMap, OfASigmoidHasHalfTheCurvatureOfEquation11) {
  const auto sigmoid = [](double x) { return 1 / (1 + std::exp(-x)); };
  const Image<float> h = heights({200, 5}, 0.1, [&](double x, double) { return sigmoid(x); });
  const Image<float> curvature = meanCurvatureOf(mapOf(h, 0.1));
  for (int x = 20; x < 180; x += 10) {
    const double at = (x + 0.5 - 100) * 0.1, y = sigmoid(at), dy = y * (1 - y),
                 ddy = dy * (1 - 2 * y);
    EXPECT_NEAR(std::abs(curvature.at(x, 2)), 0.5 * std::abs(ddy) / std::pow(1 + dy * dy, 1.5),
                2e-4);
  }
}

TEST(HeightMap, IsLitByEquation9) {
  const Image<float> flat(41, 41, 1);
  const HeightMap map = mapOf(flat, 10);
  const Image<float> near = lightRateOf(map, {false, {0, 0, 100}});
  EXPECT_NEAR(near.at(20, 20), 1e-8, 1e-12);
  const double r = std::hypot(100, 200), want = std::pow(100 / r / (r * r), 2);
  EXPECT_NEAR(near.at(40, 20) / want, 1, 1e-4);
  const Image<float> far = lightRateOf(map, {true, {1, 0, 1}});
  for (int x = 0; x < 41; ++x) EXPECT_NEAR(far.at(x, 7), 0.5, 1e-6);
  EXPECT_EQ(lightRateOf(map, {true, {1, 0, -1}}).at(3, 3), 0);
}

TEST(HeightMap, CastsAShadowAsLongAsItsWallAndTheLampSay) {
  const Image<float> h =
      heights({100, 9}, 1, [](double x, double) { return std::abs(x) < 2 ? 10.0 : 0.0; });
  const HeightMap map = mapOf(h, 1);
  const Image<float> seen = shadowOf(map, {true, {1, 0, 1}});  // from the right, at 45 degrees
  EXPECT_EQ(seen.at(80, 4), 1);
  EXPECT_EQ(seen.at(50, 4), 1);  // on the wall
  EXPECT_EQ(seen.at(45, 4), 0);
  EXPECT_EQ(seen.at(40, 4), 0);
  EXPECT_EQ(seen.at(36, 4), 1);  // 48 - 10 - a texel
  const Image<float> below = shadowOf(map, {true, {0, 1, -0.1}});
  EXPECT_EQ(below.at(80, 4), 0);
}

TEST(HeightMap, CastsASoftShadowUnderAWideLamp) {
  const Image<float> h =
      heights({100, 9}, 1, [](double x, double) { return std::abs(x) < 2 ? 10.0 : 0.0; });
  const Image<float> seen = shadowOf(mapOf(h, 1), {true, {1, 0, 1}}, {10, 64});
  EXPECT_EQ(seen.at(46, 4), 0);
  EXPECT_GT(seen.at(38, 4), 0.1);
  EXPECT_LT(seen.at(38, 4), 0.9);
  EXPECT_EQ(seen.at(20, 4), 1);
}

TEST(HeightMap, SeesAllOfTheSkyOnThePlaneAndHalfAtTheFootOfAWall) {
  const Image<float> flat(21, 21, 1);
  EXPECT_EQ(skyShareOf(mapOf(flat, 1), 10).at(10, 10), 1);
  const Image<float> wall =
      heights({80, 80}, 1, [](double x, double) { return x > 0 ? 10000.0 : 0.0; });
  EXPECT_NEAR(skyShareOf(mapOf(wall, 1), 150, 64).at(39, 40), 0.5, 0.03);
}

TEST(HeightMap, IsRefusedWithoutASpacingOrANumber) {
  Image<float> h(4, 4, 1);
  EXPECT_THROW(slopeOf(mapOf(h, 0)), ProcessingError);
  h.at(2, 1) = std::nanf("");
  EXPECT_THROW(slopeOf(mapOf(h, 1)), ProcessingError);
  const Image<float> colour(4, 4, 3);
  EXPECT_THROW(slopeOf({colour.view(), 1}), ProcessingError);
  EXPECT_THROW(shadowOf(mapOf(Image<float>(4, 4, 1), 1), {true, {0, 0, 0}}), ProcessingError);
}

}  // namespace
}  // namespace patina::mesh
