// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/prepared_picture.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/failure.h"
#include "tests/calibration/registration/twin_pictures.h"
#include "tests/support/matchers.h"

namespace patina::calibration {
namespace {

Image<float> scene() { return ShiftedSpecimen("steel_rusting", {64, 64}).at(0.6, {}, 1); }

TEST(PreparedPicture, IsTheSameForAnyGain) {
  Image<float> bright = scene();
  const PreparedPicture dark = preparePicture(bright.view());
  for (float& value : bright.texels()) value *= 7.5f;
  EXPECT_THAT(preparePicture(bright.view()).levels[0].local,
              testing::ImageNear(dark.levels[0].local, 2e-3));
}

TEST(PreparedPicture, HalvesUntilTheShorterSideWouldFallBelow32) {
  const Image<float> picture(300, 150, 1, 0.5f);
  const PreparedPicture prepared = preparePicture(picture.view());
  ASSERT_EQ(prepared.levels.size(), 3u);
  EXPECT_EQ(prepared.levels[2].size(), (SizePx{75, 38}));
  EXPECT_EQ(preparePicture(picture.view(), {}, 2).levels.size(), 2u);
}

TEST(PreparedPicture, KnowsNothingOfWhatLiesBeyondItsMask) {
  Image<float> one = scene(), other = one;
  Image<std::uint8_t> mask(64, 64, 1, 0);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      if (x >= 20) mask.at(x, y) = 255;
      for (int c = 0; c < 3 && x < 20; ++c) other.at(x, y, c) *= 1.3f + 0.05f * (y % 5);
    }
  // The floor goes with the mean of the whole picture: the tolerance.
  const PreparedPicture a = preparePicture(one.view(), mask.view()),
                        b = preparePicture(other.view(), mask.view());
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x) {
      EXPECT_EQ(a.levels[0].usable.at(x, y) != 0, x >= 23) << x;
      if (x < 23) continue;
      ASSERT_NEAR(a.levels[0].local.at(x, y), b.levels[0].local.at(x, y), 0.02);
    }
}

TEST(PreparedPicture, TakesWhatIsNoNumberForDark) {
  Image<float> picture = scene();
  picture.at(5, 5, 1) = std::nanf("");
  const PreparedPicture prepared = preparePicture(picture.view());
  for (const float value : prepared.levels[0].local.texels()) ASSERT_TRUE(std::isfinite(value));
}

TEST(PreparedPicture, RefusesWhatCannotBeRegistered) {
  EXPECT_THROW(preparePicture(Image<float>(31, 64, 1).view()), CalibrationError);
  EXPECT_THROW(preparePicture(Image<float>(64, 64, 2).view()), CalibrationError);
  const Image<std::uint8_t> mask(32, 32, 1);
  EXPECT_THROW(preparePicture(Image<float>(64, 64, 1).view(), mask.view()), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
