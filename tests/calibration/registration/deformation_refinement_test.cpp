// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/deformation_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "processing/image/random.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

constexpr SizePx kSize{128, 128};
constexpr PlacePx kBy{0.6, -0.4};

double rmsPx(const Deformation& found, PlacePx by) {
  double squares = 0;
  int count = 0;
  for (int y = 16; y < kSize.height - 16; y += 4)
    for (int x = 16; x < kSize.width - 16; x += 4, ++count) {
      const PlacePx to = found.moved({static_cast<double>(x), static_cast<double>(y)});
      squares += std::pow(to.x - x - by.x, 2) + std::pow(to.y - y - by.y, 2);
    }
  return std::sqrt(squares / count);
}

Deformation noField() {
  Deformation out;
  out.spacing_px = 32;
  out.size = kSize;
  out.beyond_px = Image<float>(5, 5, 2);
  return out;
}

// Wide soft spots that come: blue falls most, as under the halo of a freckle.
void stain(Image<float>& picture) {
  constexpr int kSpots = 30;
  const double left[] = {0.75, 0.6, 0.4};
  for (std::uint64_t k = 0; k < kSpots; ++k) {
    const double u = kSize.width * uniform(hashSeed(k, 1)),
                 v = kSize.height * uniform(hashSeed(k, 2));
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) {
        const double there = std::exp(-(std::pow(x - u, 2) + std::pow(y - v, 2)) / 50);
        for (int c = 0; c < 3; ++c)
          picture.at(x, y, c) *= static_cast<float>(std::pow(left[c], there));
      }
  }
}

TEST(DeformationRefinement, FollowsASurfaceThatStainsInAColourOfItsOwn) {
  const ShiftedSpecimen steel("steel_rusting", kSize);
  const Image<float> still = steel.at(0.6, {}, 1);
  Image<float> moved = steel.at(0.6, kBy, 2);
  stain(moved);
  Progress progress;
  const Deformation by_luma = findDeformation(
      preparePicture(still.view()), preparePicture(moved.view()), kNoMotion, {}, progress);
  Deformation found = by_luma;
  const ColourPicture reference = colourPicture(still.view());
  refineDeformation({&reference}, colourPicture(moved.view()), found, progress);
  std::printf("a stained surface that moved: off by %.3f px RMS, by luma alone %.3f px\n",
              rmsPx(found, kBy), rmsPx(by_luma, kBy));
  EXPECT_LE(rmsPx(found, kBy), 0.1);
}

TEST(DeformationRefinement, LeavesOutWhatIsMasked) {
  const ShiftedSpecimen steel("steel_rusting", kSize);
  const Image<float> still = steel.at(0.6, {}, 1);
  Image<float> moved = steel.at(0.6, kBy, 2);
  Image<std::uint8_t> mask(kSize.width, kSize.height, 1, 255);
  for (int y = 40; y < 90; ++y)
    for (int x = 40; x < 90; ++x) {
      mask.at(x, y) = 0;
      for (int c = 0; c < 3; ++c) moved.at(x, y, c) = still.at(x, y, c);
    }
  Progress progress;
  Deformation found = noField(), held_back = noField();
  const ColourPicture reference = colourPicture(still.view(), std::as_const(mask).view());
  refineDeformation({&reference}, colourPicture(moved.view()), found, progress);
  const ColourPicture whole = colourPicture(still.view());
  refineDeformation({&whole}, colourPicture(moved.view()), held_back, progress);
  EXPECT_LE(rmsPx(found, kBy), 0.1);
  EXPECT_GT(rmsPx(held_back, kBy), 2 * rmsPx(found, kBy));
}

TEST(DeformationRefinement, TakesPicturesOfOneChannel) {
  const ShiftedSpecimen steel("steel_rusting", kSize);
  const auto green = [&](const Image<float>& in) {
    Image<float> out(kSize.width, kSize.height, 1);
    for (int y = 0; y < kSize.height; ++y)
      for (int x = 0; x < kSize.width; ++x) out.at(x, y) = in.at(x, y, 1);
    return out;
  };
  const Image<float> still = green(steel.at(0.6, {}, 1)), moved = green(steel.at(0.6, kBy, 2));
  Progress progress;
  Deformation found = noField();
  const ColourPicture reference = colourPicture(still.view());
  refineDeformation({&reference}, colourPicture(moved.view()), found, progress);
  EXPECT_LE(rmsPx(found, kBy), 0.1);
}

}  // namespace
}  // namespace patina::calibration
