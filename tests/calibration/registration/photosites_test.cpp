// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/photosites.h"

#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "processing/image/linear_mosaic.h"
#include "processing/image/random.h"
#include "processing/image/warp.h"

namespace patina::calibration {
namespace {

Image<float> noisyMosaic() {
  Image<float> mosaic(64, 48, 1);
  for (std::size_t k = 0; k < mosaic.texels().size(); ++k)
    mosaic.texels()[k] = static_cast<float>(0.5 + 0.02 * uniform(hashSeed(7, k)));
  return mosaic;
}

TEST(Photosites, OfAnInterpolatedMosaicAreItsOwnPixelsWhicheverTheCell) {
  const Image<float> mosaic = noisyMosaic();
  for (const std::array<std::uint8_t, 4>& cfa :
       {std::array<std::uint8_t, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    const Photosites sites = photositesOf(demosaicLinear(mosaic.view(), cfa).view());
    ASSERT_FALSE(sites.empty());
    EXPECT_EQ(sites.cfa, cfa);
    EXPECT_EQ(sites.samples.texels(), mosaic.texels());
  }
}

TEST(Photosites, OfWhatNoMosaicIsBehindAreNone) {
  const Image<float> grey = noisyMosaic();
  EXPECT_TRUE(photositesOf(grey.view()).empty()) << "one channel";
  Image<float> colours(64, 48, 3);
  for (std::size_t k = 0; k < colours.texels().size(); ++k)
    colours.texels()[k] = static_cast<float>(uniform(hashSeed(8, k)));
  EXPECT_TRUE(photositesOf(std::as_const(colours).view()).empty()) << "three of its own";
  EXPECT_TRUE(photositesOf(demosaicDetailed(grey.view(), {0, 1, 1, 2}).view()).empty());
  const Image<float> interpolated = demosaicLinear(grey.view(), {0, 1, 1, 2});
  const Image<float> moved =
      warpBilinear(interpolated.view(), {1, 0, 0.5, 0, 1, 0.5, 0, 0, 1}, interpolated.size());
  EXPECT_TRUE(photositesOf(moved.view()).empty()) << "resampled since";
}

}  // namespace
}  // namespace patina::calibration
