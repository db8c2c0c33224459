// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/sphere_rim.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A ball, its edge shared between texels, on a patterned ground.
Image<float> ballAt(const Disc& disc, SizePx size, double ground = 0.4) {
  Image<float> picture(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double cover = std::clamp(
          disc.radius_px - std::hypot(x + 0.5 - disc.x_px, y + 0.5 - disc.y_px) + 0.5, 0.0, 1.0);
      const double texture = ground * (1 + 0.3 * std::sin(x * 0.21) * std::cos(y * 0.17)) +
                             0.01 * gaussian(hashSeed(5, static_cast<std::uint64_t>(x),
                                                      static_cast<std::uint64_t>(y)));
      picture.at(x, y) = static_cast<float>(0.03 * cover + texture * (1 - cover));
    }
  return picture;
}

TEST(SphereRim, IsFoundToATenthOfAPixel) {
  for (const Disc& truth :
       {Disc{130.3, 101.7, 40.4}, Disc{210.2, 80.9, 62.6}, Disc{60, 150, 12.3}}) {
    const MirrorSphere found = findSphere(ballAt(truth, {320, 200}).view(), {});
    EXPECT_NEAR(found.disc().x_px, truth.x_px, 0.1);
    EXPECT_NEAR(found.disc().y_px, truth.y_px, 0.1);
    EXPECT_NEAR(found.disc().radius_px, truth.radius_px, 0.2);
    EXPECT_GT(found.report().inlier_share, 0.7);
  }
}

TEST(SphereRim, IsRefusedWhenTheFrameCutsItOff) {
  EXPECT_THAT(([] {
                findSphere(ballAt({30, 100, 40}, {320, 200}).view(), {});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("cut off by the frame")));
  EXPECT_THAT(([] {
                sphereAt({300, 100, 40}, {320, 200}, {});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("cut off by the frame")));
}

TEST(SphereRim, IsNotSeenWhereThereIsNone) {
  EXPECT_THAT(([] {
                findSphere(ballAt({-500, 0, 1}, {320, 200}).view(), {});
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("--sphere x,y,radius")));
}

TEST(SphereRim, GivesTheNormalOfEveryTexel) {
  const MirrorSphere sphere = sphereAt({100, 80, 50}, {200, 160}, {});
  const auto touch = sphere.touchAt(100 + 30, 80 - 40 * 0.75);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(touch->normal[0], 0.6, 1e-6);
  EXPECT_NEAR(touch->normal[1], 0.6, 1e-6) << "y up";
  EXPECT_NEAR(touch->normal[2], std::sqrt(1 - 0.72), 1e-6);
  EXPECT_FALSE(sphere.touchAt(151, 80));
}

TEST(SphereRim, OfAPinholeCameraTellsHowFarTheSphereIs) {
  SphereCamera camera;
  camera.pinhole = true;
  camera.focal_px = 400;
  // On the axis, ten radii away: the rim's angle has the sine 1/10.
  const double radius_px = 400 * std::tan(std::asin(0.1));
  const MirrorSphere sphere = sphereAt({100, 80, radius_px}, {200, 160}, camera);
  EXPECT_NEAR(sphere.middle()[2], -10, 1e-6);
  const auto touch = sphere.touchAt(100, 80);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(touch->normal[2], 1, 1e-6);
}

TEST(SphereRim, RefusesACameraThatIsNotDescribed) {
  SphereCamera camera;
  camera.k1 = -0.1;
  EXPECT_THAT(([&] {
                sphereAt({100, 80, 50}, {200, 160}, camera);
              }),
              ThrowsMessage<CalibrationError>(HasSubstr("needs its focal length")));
}

TEST(SphereRim, OfAShrunkPictureFitsTheWholeOne) {
  SphereCamera camera;
  camera.focal_px = 300;
  camera.k1 = -0.1;
  const MirrorSphere small = sphereAt({50, 40, 25}, {100, 80}, camera);
  camera.focal_px = 600;
  const MirrorSphere large = sphereAt({100, 80, 50}, {200, 160}, camera);
  const auto a = small.enlarged(2).touchAt(120, 60), b = large.touchAt(120, 60);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->normal[0], b->normal[0], 1e-6);
  EXPECT_NEAR(small.enlarged(2).disc().radius_px, 50, 1e-9);
}

}  // namespace
}  // namespace patina::calibration
