// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/motion.h"

#include <gtest/gtest.h>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

constexpr Motion kSome{1.1, -0.2, 7, 0.3, 0.9, -4, 1e-4, -2e-4, 1};

TEST(Motion, TimesItsInverseIsNone) {
  EXPECT_LT(cornersApart(chained(inverse(kSome), kSome), kNoMotion, {640, 480}), 1e-9);
  EXPECT_LT(cornersApart(chained(kSome, inverse(kSome)), kNoMotion, {640, 480}), 1e-9);
}

TEST(Motion, IsSeenInASmallerPictureAtTheMeansOfItsPixels) {
  // The pixel (3, 5) of a picture 4 times smaller has its middle at (13.5, 21.5).
  const PlacePx fine = moved(kSome, {13.5, 21.5});
  const PlacePx coarse = moved(atLevel(kSome, 2), {3, 5});
  EXPECT_NEAR(coarse.x, (fine.x - 1.5) / 4, 1e-9);
  EXPECT_NEAR(coarse.y, (fine.y - 1.5) / 4, 1e-9);
  EXPECT_LT(cornersApart(fromLevel(atLevel(kSome, 2), 2), kSome, {640, 480}), 1e-9);
}

TEST(Motion, IsImplausibleWhenItMirrorsOrFoldsThePicture) {
  EXPECT_TRUE(isPlausible(kSome, {640, 480}));
  EXPECT_FALSE(isPlausible({-1, 0, 640, 0, 1, 0, 0, 0, 1}, {640, 480}));
  EXPECT_FALSE(isPlausible({1, 0, 0, 0, 1, 0, -0.01, 0, 1}, {640, 480}));
  EXPECT_FALSE(isPlausible({0.1, 0, 0, 0, 0.1, 0, 0, 0, 1}, {640, 480}));
}

TEST(Motion, ModelsGoByTheirNames) {
  for (const char* model : {"translation", "euclidean", "affine", "homography"})
    EXPECT_STREQ(name(parseMotionModel(model)), model);
  EXPECT_THROW(parseMotionModel("perspective"), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
