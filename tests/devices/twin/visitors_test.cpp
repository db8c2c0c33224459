// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/visitors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace patina::devices::twin {
namespace {

constexpr SizePx kSize{128, 96};
constexpr std::size_t kPixels = 128 * 96;

double areaOf(const std::vector<float>& share) {
  return std::accumulate(share.begin(), share.end(), 0.0) / static_cast<double>(share.size());
}

TEST(Visitors, AHandCoversAPartOfThePictureAndComesFromItsEdge) {
  for (std::uint64_t key = 0; key < 60; ++key) {
    const std::vector<float> share = handShare(kSize, key);
    EXPECT_GT(areaOf(share), 0.03) << key;
    EXPECT_LT(areaOf(share), 0.5) << key;
    float edge = 0;
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x)
        if (x == 0 || y == 0 || x == kSize.width - 1 || y == kSize.height - 1)
          edge = std::max(edge, share[static_cast<std::size_t>(y) * 128 + x]);
    EXPECT_EQ(edge, 1) << key;
  }
}

TEST(Visitors, AHandIsWhereItsSeedSaysAtAnySize) {
  const std::vector<float> small = handShare({64, 48}, 7), large = handShare({256, 192}, 7);
  EXPECT_NEAR(areaOf(small), areaOf(large), 0.01);
  EXPECT_NE(handShare(kSize, 7), handShare(kSize, 8));
}

TEST(Visitors, AHandReflectsTheLightThatFallsOnItAndHasItsColour) {
  const std::vector<float> share = handShare(kSize, 3);
  std::vector<float> dark(kPixels, 0.2f), lit(kPixels, 0.2f), brighter(kPixels, 0.2f);
  drawHand(dark, std::vector<float>(kPixels, 0.0f), kSize, 3);
  drawHand(lit, std::vector<float>(kPixels, 0.5f), kSize, 3);
  drawHand(brighter, std::vector<float>(kPixels, 1.0f), kSize, 3);
  double red = 0, blue = 0;
  for (int y = 0; y < kSize.height; ++y)
    for (int x = 0; x < kSize.width; ++x) {
      const std::size_t k = static_cast<std::size_t>(y) * 128 + x;
      if (share[k] == 0) {
        ASSERT_EQ(lit[k], 0.2f);
      }
      if (share[k] < 1) continue;
      ASSERT_EQ(dark[k], 0);
      ASSERT_NEAR(brighter[k], 2 * lit[k], 1e-6);
      if ((x & 1) + (y & 1) == 0) red += lit[k];
      if ((x & 1) + (y & 1) == 2) blue += lit[k];
    }
  EXPECT_GT(red, 2 * blue);
}

TEST(Visitors, AnInsectCrossesThePictureWithoutAJump) {
  for (std::uint64_t key = 0; key < 20; ++key) {
    const InsectPlace middle = insectAt(kSize, key, 0.5);
    EXPECT_GT(middle.x_px, 0);
    EXPECT_LT(middle.x_px, kSize.width);
    for (const double end : {0.0, 1.0}) {
      const InsectPlace place = insectAt(kSize, key, end);
      EXPECT_GT(std::hypot(place.x_px - 64, place.y_px - 48), 79) << "beyond a corner's distance";
    }
    for (int i = 0; i < 1000; ++i) {
      const InsectPlace a = insectAt(kSize, key, i / 1000.0),
                        b = insectAt(kSize, key, (i + 1) / 1000.0);
      const double dx = b.x_px - a.x_px, dy = b.y_px - a.y_px;
      ASSERT_LT(std::hypot(dx, dy), 0.5);
      ASSERT_NEAR(std::remainder(std::atan2(dy, dx) - a.heading_rad, 2 * M_PI), 0, 0.05)
          << "looks where it goes";
    }
  }
}

TEST(Visitors, AnInsectIsASmallDarkSpotWhereItIs) {
  std::vector<float> light(kPixels, 1.0f);
  const InsectPlace place = insectAt(kSize, 5, 0.45);
  drawInsect(light, kSize, place);
  double area = 0, x_px = 0, y_px = 0;
  for (std::size_t k = 0; k < kPixels; ++k) {
    const std::size_t column = k % 128, row = k / 128;
    area += 1 - light[k];
    x_px += (1 - light[k]) * (static_cast<double>(column) + 0.5);
    y_px += (1 - light[k]) * (static_cast<double>(row) + 0.5);
  }
  EXPECT_NEAR(x_px / area, place.x_px, 0.5 * place.half_length_px);
  EXPECT_NEAR(y_px / area, place.y_px, 0.5 * place.half_length_px);
  EXPECT_GT(area, 0.5 * place.half_length_px * place.half_length_px);
  EXPECT_LT(area, 4 * place.half_length_px * place.half_length_px);
}

}  // namespace
}  // namespace patina::devices::twin
