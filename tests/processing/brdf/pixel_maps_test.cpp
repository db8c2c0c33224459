// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/pixel_maps.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::brdf {
namespace {

constexpr Filters kRggb{0, 1, 1, 2};

BrdfMaps flatMaps(SizePx size, int channels) {
  BrdfMaps maps;
  maps.diffuse = Image<float>(size.width, size.height, channels, 0.3f);
  maps.specular = Image<float>(size.width, size.height, channels, 0.04f);
  maps.roughness = Image<float>(size.width, size.height, 1, 0.2f);
  maps.normal = Image<float>(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) maps.normal.at(x, y, 2) = 1;
  maps.extra["Confidence"] = Image<float>(size.width, size.height, 1, 1.0f);
  return maps;
}

TEST(OwnColours, AreWhatEachPixelsFilterLetsThrough) {
  Image<float> picture(4, 2, 3);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 4; ++x)
      for (int c = 0; c < 3; ++c) picture.at(x, y, c) = static_cast<float>(100 * c + 10 * y + x);
  const Image<float> own = ownColours(std::as_const(picture).view(), kRggb);
  EXPECT_EQ(own.texels(), (std::vector<float>{0, 101, 2, 103, 110, 211, 112, 213}));
}

TEST(TexelsOfPixels, AreMeansWithNormalsOfLengthOne) {
  BrdfMaps pixels = flatMaps({4, 2}, 3);
  pixels.diffuse.at(0, 0, 1) = 0.7f;
  pixels.roughness.at(3, 1) = 0.6f;
  pixels.normal.at(0, 0, 0) = 0.8f, pixels.normal.at(0, 0, 2) = 0.6f;
  pixels.extra["Confidence"].at(1, 1) = 0;
  const BrdfMaps texels = texelsOfPixels(pixels, Image<std::uint8_t>(4, 2, 1, 1), {}, 2);
  ASSERT_EQ(texels.diffuse.size(), (SizePx{2, 1}));
  EXPECT_FLOAT_EQ(texels.diffuse.at(0, 0, 1), 0.4f);
  EXPECT_FLOAT_EQ(texels.diffuse.at(0, 0, 0), 0.3f);
  EXPECT_FLOAT_EQ(texels.roughness.at(1, 0), 0.3f);
  EXPECT_FLOAT_EQ(texels.extra.at("Confidence").at(0, 0), 0.75f);
  EXPECT_FLOAT_EQ(texels.normal.at(0, 0, 0), 0.2f / std::hypot(0.2f, 0.9f));
}

TEST(TexelsOfPixels, TakeWhatIsNotToldFromThoseAround) {
  BrdfMaps pixels = flatMaps({8, 8}, 3);
  pixels.diffuse.at(4, 4, 2) = 50;
  Image<std::uint8_t> told(8, 8, 1, 1);
  told.at(4, 4) = 0;
  EXPECT_FLOAT_EQ(texelsOfPixels(pixels, told, {}, 1).diffuse.at(4, 4, 2), 0.3f);
  EXPECT_FLOAT_EQ(texelsOfPixels(pixels, told, {}, 4).diffuse.at(1, 1, 2), 0.3f);
}

// Red, green and blue of one surface change together: grey detail as fine as a pixel is there in
// all three; by the means of neighbours it would be off by 0.064.
TEST(TexelsOfPixels, OfAMosaicShareTheirColoursDetail) {
  BrdfMaps pixels = flatMaps({16, 16}, 1);
  const auto truth = [](int x, int) { return static_cast<float>(0.4 + 0.1 * std::sin(1.2 * x)); };
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x) pixels.diffuse.at(x, y) = truth(x, y);
  const BrdfMaps texels = texelsOfPixels(pixels, Image<std::uint8_t>(16, 16, 1, 1), kRggb, 1);
  ASSERT_EQ(texels.diffuse.channels(), 3);
  for (int x = 4; x < 12; ++x)
    for (int y = 6; y < 10; ++y)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(texels.diffuse.at(x, y, c), truth(x, y), 0.03) << x << ' ' << y << ' ' << c;
}

}  // namespace
}  // namespace patina::brdf
