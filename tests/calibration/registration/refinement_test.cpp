// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/refinement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"
#include "processing/image/warp.h"

namespace patina::calibration {
namespace {

// Smooth seeded waves, so that a shifted picture can be worked out exactly.
Image<float> waves(SizePx size, PlacePx shift, std::uint64_t seed = 0) {
  Image<float> out(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      double light = 1;
      for (std::uint64_t k = 0; k < 24; ++k) {
        const double turn = 2 * M_PI * uniform(hashSeed(seed, 1, k)),
                     pace = 0.05 + 0.5 * uniform(hashSeed(seed, 2, k));
        light += 0.05 *
                 std::sin(pace * (std::cos(turn) * (x - shift.x) + std::sin(turn) * (y - shift.y)) +
                          6.28 * uniform(hashSeed(seed, 3, k)));
      }
      out.at(x, y) = static_cast<float>(light);
    }
  return out;
}

TEST(Refinement, FindsAShiftToAFewHundredthsOfAPixelWithoutNoise) {
  const PreparedPicture still = preparePicture(waves({160, 120}, {}).view());
  for (const PlacePx by : {PlacePx{0.25, 0.75}, PlacePx{-3.4, 2.6}, PlacePx{6.5, -5.25}}) {
    const Refinement found =
        refineTranslation(still, preparePicture(waves({160, 120}, by).view()), kNoMotion);
    EXPECT_TRUE(found.converged);
    EXPECT_NEAR(found.frame_from_reference[2], by.x, 0.015);
    EXPECT_NEAR(found.frame_from_reference[5], by.y, 0.015);
  }
}

TEST(Refinement, IsNotPulledByWhatHasChanged) {
  const PreparedPicture still = preparePicture(waves({160, 120}, {}).view());
  Image<float> frame = waves({160, 120}, {1.3, -0.6});
  const Image<float> other = waves({160, 120}, {}, 9);
  for (int y = 30; y < 90; ++y)  // a fifth of the picture is something else
    for (int x = 40; x < 100; ++x) frame.at(x, y) = other.at(x, y);
  const Refinement found = refineTranslation(still, preparePicture(frame.view()), kNoMotion);
  EXPECT_NEAR(found.frame_from_reference[2], 1.3, 0.05);
  EXPECT_NEAR(found.frame_from_reference[5], -0.6, 0.05);
}

TEST(Refinement, FindsAHomographyByEcc) {
  const Image<float> still = waves({160, 120}, {});
  const Motion truth{1.01, 0.01, -1.5, -0.008, 0.995, 2.5, 2e-5, -3e-5, 1};
  const Image<float> frame = warpBilinear(still.view(), inverse(truth), still.size(), 1);
  const Refinement found = refineByEcc(preparePicture(still.view()), preparePicture(frame.view()),
                                       kNoMotion, MotionModel::kHomography, 1, 0);
  EXPECT_TRUE(found.converged);
  EXPECT_LT(cornersApart(found.frame_from_reference, truth, still.size()), 0.2);
}

TEST(Refinement, SaysWhenEccFindsNothingInCommon) {
  const Image<float> flat(160, 120, 1, 0.5f);
  const Refinement found =
      refineByEcc(preparePicture(waves({160, 120}, {}).view()), preparePicture(flat.view()),
                  kNoMotion, MotionModel::kAffine, 1, 0);
  EXPECT_FALSE(found.converged);
  EXPECT_EQ(found.frame_from_reference, kNoMotion);
}

}  // namespace
}  // namespace patina::calibration
