// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/agreement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

class AgreementOf : public ::testing::Test {
 protected:
  const ShiftedSpecimen twin_{"steel_rusting", {256, 256}};
  const Image<float> still_ = twin_.at(0.6, {}, 1);
  Image<float> frame_ = twin_.at(0.6, {}, 2);
  Agreement found() const {
    return agreementOf(preparePicture(still_.view()), preparePicture(frame_.view()), kNoMotion);
  }
};

TEST_F(AgreementOf, TwoPicturesOfTheSameIsWhole) {
  const Agreement same = found();
  EXPECT_EQ(same.judged_blocks, 256);
  EXPECT_GT(same.share, 0.98);
  EXPECT_GT(same.zncc, 0.9);
  EXPECT_LT(same.residual_px, 0.4);
  EXPECT_LT(same.uncertainty_px, 0.05);
  EXPECT_NEAR(same.contrast_coarse, 1, 0.05);
}

TEST_F(AgreementOf, APictureWithACardOverItNamesItsPlace) {
  for (int y = 64; y < 128; ++y)
    for (int x = 96; x < 176; ++x)
      for (int c = 0; c < 3; ++c) frame_.at(x, y, c) = 0.8f;
  const Agreement covered = found();
  EXPECT_NEAR(covered.covered, 4 * 5 / 256.0, 0.05);
  EXPECT_LE(std::abs(covered.covered_px.x - 96), 16);
  EXPECT_LE(std::abs(covered.covered_px.y - 64), 16);
  EXPECT_LE(std::abs(covered.covered_px.width - 80), 32);
}

TEST_F(AgreementOf, APictureInFogLosesContrastCoarseAndFine) {
  for (float& value : frame_.texels()) value = 0.6f * value + 0.4f * 0.25f;
  const Agreement fogged = found();
  EXPECT_LT(fogged.contrast_coarse, 0.8);
  EXPECT_GT(fogged.contrast_fine, 0.7 * fogged.contrast_coarse);
}

TEST_F(AgreementOf, ABlockThatCoversNothingNewIsNotFresh) {
  for (int y = 64; y < 128; ++y)
    for (int x = 96; x < 176; ++x)
      for (int c = 0; c < 3; ++c) frame_.at(x, y, c) = 0.8f;
  Agreement covered = found();
  ASSERT_GT(covered.covered, 0.04);
  findCovered(covered, covered.blocks);
  EXPECT_EQ(covered.covered, 0);
  EXPECT_EQ(covered.covered_px, RectPx{});
}

TEST_F(AgreementOf, WhatIsLeftOutIsWhatDisagrees) {
  for (int y = 64; y < 128; ++y)
    for (int x = 96; x < 176; ++x)
      for (int c = 0; c < 3; ++c) frame_.at(x, y, c) = 0.8f;
  const PreparedPicture reference = preparePicture(still_.view());
  const Image<std::uint8_t> left = agreeingPixels(found(), reference);
  EXPECT_EQ(left.at(136, 96), 0);
  EXPECT_EQ(left.at(30, 200), 255);
}

}  // namespace
}  // namespace patina::calibration
