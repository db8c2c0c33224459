// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/feature_start.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/warp.h"
#include "tests/calibration/registration/twin_pictures.h"

namespace patina::calibration {
namespace {

TEST(FeatureStart, FindsATurnOfThirtyDegrees) {
  const Image<float> still = ShiftedSpecimen("steel_rusting", {192, 192}).at(0.6, {}, 1);
  const double c = std::cos(0.52), s = std::sin(0.52);
  const Motion about{c, -s, 96 * (1 - c + s), s, c, 96 * (1 - c - s), 0, 0, 1};
  const Image<float> frame = warpBilinear(still.view(), inverse(about), still.size(), 0.2f);
  const PreparedPicture a = preparePicture(still.view()), b = preparePicture(frame.view());
  for (const MotionModel model :
       {MotionModel::kEuclidean, MotionModel::kAffine, MotionModel::kHomography}) {
    const auto found = startByFeatures(a, b, model);
    ASSERT_TRUE(found) << name(model);
    EXPECT_LT(cornersApart(*found, about, still.size()), 6) << name(model);
    EXPECT_EQ(startByFeatures(a, b, model), found) << "RANSAC draws the same again";
  }
}

TEST(FeatureStart, FindsNothingWhereThereIsNothing) {
  const PreparedPicture flat = preparePicture(Image<float>(128, 128, 1, 0.5f).view());
  EXPECT_FALSE(startByFeatures(flat, flat, MotionModel::kAffine));
}

TEST(FeatureStart, PhaseCorrelationFindsAThirdOfThePicture) {
  const ShiftedSpecimen twin("steel_rusting", {128, 128});
  const Motion found = startByPhase(preparePicture(twin.at(0.6, {}, 1).view()),
                                    preparePicture(twin.at(0.6, {38, -29}, 2).view()));
  EXPECT_NEAR(found[2], 38, 1);
  EXPECT_NEAR(found[5], -29, 1);
}

}  // namespace
}  // namespace patina::calibration
