// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/pixel_map.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "processing/image/random.h"
#include "tests/support/matchers.h"

namespace patina {
namespace {

using testing::ImageNear;

Image<float> noise(int width, int height) {
  Image<float> out(width, height, 3);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(uniform(hashSeed(1, i)));
  return out;
}
PixelMap scaled(SizePx size, double scale, double angle_rad, double x0, double y0) {
  const double c = scale * std::cos(angle_rad), s = scale * std::sin(angle_rad);
  return composed(identityMap({0, 0, size.width, size.height}), {c, -s, x0, s, c, y0, 0, 0, 1});
}
// A wave of so many pixels along both diagonals.
Image<float> waves(SizePx size, double period_px) {
  Image<float> out(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      out.at(x, y) = static_cast<float>(0.5 + 0.5 * std::sin(2 * M_PI * x / period_px) *
                                                  std::cos(2 * M_PI * y / period_px));
  return out;
}

TEST(Resample, OfACropIsTheCropToTheBit) {
  const Image<float> in = noise(20, 15);
  const Image<float> out = resample(in.view(), identityMap({3, 2, 9, 8}));
  EXPECT_THAT(out, ImageNear(copyOf<float>(in.view().crop({3, 2, 9, 8})), 0));
}

TEST(Resample, KeepsAConstantHoweverTheMapTurnsAndShrinks) {
  const Image<float> in(60, 50, 2, 0.25f);
  for (const double scale : {0.3, 1.0, 1.7, 5.0})
    EXPECT_THAT(resample(in.view(), scaled({6, 6}, scale, 0.4, 20, 10)),
                ImageNear(Image<float>(6, 6, 2, 0.25f), 1e-6));
}

TEST(Resample, FollowsASmoothPictureBetweenItsPixels) {
  const Image<float> in = waves({64, 64}, 24);
  const Image<float> out = resample(in.view(), scaled({40, 40}, 0.7, 0.5, 22, 8));
  const double c = 0.7 * std::cos(0.5), s = 0.7 * std::sin(0.5);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) {
      const double at_x = c * x - s * y + 22, at_y = s * x + c * y + 8;
      EXPECT_NEAR(out.at(x, y),
                  0.5 + 0.5 * std::sin(2 * M_PI * at_x / 24) * std::cos(2 * M_PI * at_y / 24),
                  2e-3);
    }
}

TEST(Resample, AveragesWhatIsFinerThanATexelInsteadOfAliasingIt) {
  Image<float> in(240, 240, 1);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 240; ++x) in.at(x, y) = static_cast<float>((x + y) % 2);
  const Image<float> out = resample(in.view(), scaled({40, 40}, 4.37, 0.1, 20, 10));
  for (const float v : out.texels()) EXPECT_NEAR(v, 0.5, 0.01);
}

TEST(Resample, GivesTheOutsideWhereTheSourceIsNotSeen) {
  const Image<float> in(4, 4, 1, 1.0f);
  PixelMap map = identityMap({-2, 0, 8, 4});
  map.source_px.at(4, 1, 0) = std::numeric_limits<float>::quiet_NaN();
  const Image<float> out = resample(in.view(), map, -1);
  EXPECT_EQ(out.at(1, 2), -1);
  EXPECT_EQ(out.at(2, 2), 1);
  EXPECT_EQ(out.at(5, 2), 1);
  EXPECT_EQ(out.at(6, 2), -1);
  EXPECT_EQ(out.at(4, 1), -1);
}

TEST(ComposedMaps, OfTwoMotionsAreTheMotionOfTheirProduct) {
  const std::array<double, 9> first{1, 0.01, 3, -0.02, 1, 2, 1e-4, 0, 1};
  const PixelMap once =
      composed(composed(identityMap({0, 0, 9, 7}), first), {2, 0, 1, 0, 2, -1, 0, 0, 1});
  const double w = 8e-4 + 1;
  EXPECT_NEAR(once.source_px.at(8, 6, 0), 2 * (8 + 0.06 + 3) / w + 1, 1e-5);
  EXPECT_NEAR(once.source_px.at(8, 6, 1), 2 * (-0.16 + 6 + 2) / w - 1, 1e-5);
}

TEST(ComposedMaps, GoThroughADenseMapAndEndWhereItEnds) {
  PixelMap field = identityMap({0, 0, 30, 30});
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x) field.source_px.at(x, y, 0) += 0.1f * static_cast<float>(y);
  const PixelMap both = composed(scaled({10, 10}, 3.3, 0, -0.4, 0.5), field);
  EXPECT_NEAR(both.source_px.at(5, 4, 0), 16.1 + 1.37, 1e-5);
  EXPECT_NEAR(both.source_px.at(0, 0, 0), -0.4 + 0.05, 1e-5);  // in the outer half pixel
  EXPECT_NEAR(both.source_px.at(5, 4, 1), 13.7, 1e-5);
  EXPECT_TRUE(std::isnan(both.source_px.at(9, 9, 0)));
}

TEST(ComposedMaps, SayHowFarTexelsLieApart) {
  EXPECT_NEAR(meanStep(scaled({10, 10}, 2.5, 0.7, 0, 0)), 2.5, 1e-6);
  PixelMap none = identityMap({0, 0, 2, 2});
  for (float& v : none.source_px.texels()) v = std::numeric_limits<float>::quiet_NaN();
  EXPECT_TRUE(std::isnan(meanStep(none)));
}

}  // namespace
}  // namespace patina
