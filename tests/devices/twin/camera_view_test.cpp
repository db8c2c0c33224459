// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/camera_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/failure.h"

namespace patina::devices::twin {
namespace {

const LensProfile& lens() { return referenceProfile().lens; }

TEST(Lens, CornersSeeTheCornersAndBarrelMagnifiesTheMiddle) {
  const SizePx size{512, 512};
  const SampleGrid grid = CameraView(size, lens(), {}, 60).ground();
  // The outermost centre lies half a pixel inside the corner.
  EXPECT_NEAR(grid.x_mm[0], -30, 0.1);
  EXPECT_NEAR(grid.y_mm[0], 30, 0.1);
  const float middle_texel = grid.x_mm[grid.index(257, 256)] - grid.x_mm[grid.index(256, 256)];
  const float edge_texel = grid.x_mm[grid.index(511, 256)] - grid.x_mm[grid.index(510, 256)];
  EXPECT_LT(middle_texel, 60.0f / 512);
  EXPECT_GT(edge_texel, middle_texel * 1.05f);
}

TEST(Lens, FollowsItsDistortionFormula) {
  const SizePx size{512, 512};
  const SampleGrid grid = CameraView(size, lens(), {}, 60).ground();
  const double focal_px = lens().focal_length * 512;
  const double mm = grid.texel_mm;  // of the undistorted picture
  for (const int x : {300, 400, 511}) {
    const double r_u = grid.x_mm[grid.index(x, 255)] / mm / focal_px;
    const double y_u = grid.y_mm[grid.index(x, 255)] / mm / focal_px;
    const double r2 = r_u * r_u + y_u * y_u;
    const double r_d = r_u * (1 + lens().k1 * r2 + lens().k2 * r2 * r2);
    EXPECT_NEAR(r_d * focal_px, x + 0.5 - 256, 0.01);
  }
}

TEST(Lens, LosesThirtyPercentInTheCorners) {
  const std::vector<float> falloff = lensFalloff({512, 384}, lens());
  EXPECT_NEAR(falloff[0], 0.70, 0.005);
  EXPECT_NEAR(falloff[192 * 512 + 256], 1.0, 1e-4);
}

const LensProfile& noLens() {
  static const LensProfile none{0, 0, 1.2, 0};
  return none;
}

TEST(CameraView, APinholeStraightAboveSeesWhatItsFocalLengthSays) {
  CameraPose pose;
  pose.distant = false;
  pose.position_mm = {5, -3, 300};
  pose.look_at_mm = {5, -3, 0};
  pose.focal_widths = 2;
  const CameraView view({100, 80}, noLens(), pose, 60);
  const SampleGrid& ground = view.ground();
  // Half a width of the picture is a quarter of the focal length: 75 mm from the axis.
  EXPECT_NEAR(ground.x_mm[ground.index(0, 40)], 5 - 75 * 49.5 / 50, 1e-3);
  EXPECT_NEAR(ground.y_mm[ground.index(50, 0)], -3 + 75 * 39.5 / 50, 1e-3);
  EXPECT_NEAR(ground.texel_mm, 1.5, 1e-4);
  const ViewRow row = view.viewRow(40);
  EXPECT_NEAR(row.x[0], 74.25 / std::sqrt(74.25 * 74.25 + 0.75 * 0.75 + 300 * 300), 1e-5);
}

TEST(CameraView, AnObliqueOneLooksAtItsAimAndSeesTheFarSideSmaller) {
  CameraPose pose;
  pose.distant = false;
  pose.position_mm = {0, -300, 300};
  const CameraView view({101, 101}, noLens(), pose, 60);
  const SampleGrid& g = view.ground();
  EXPECT_NEAR(g.x_mm[g.index(50, 50)], 0, 1e-3);
  EXPECT_NEAR(g.y_mm[g.index(50, 50)], 0, 1e-3);
  EXPECT_GT(g.y_mm[g.index(50, 0)], 0) << "far is up";
  const float far = g.x_mm[g.index(51, 0)] - g.x_mm[g.index(50, 0)],
              near = g.x_mm[g.index(51, 100)] - g.x_mm[g.index(50, 100)];
  EXPECT_GT(far, near * 1.5f);
}

TEST(CameraView, RollTurnsThePictureAndABumpShiftsIt) {
  CameraPose pose;
  pose.roll_deg = 90;
  const CameraView rolled({64, 64}, lens(), pose, 60), straight({64, 64}, lens(), {}, 60);
  const SampleGrid &r = rolled.ground(), &s = straight.ground();
  // Turned counterclockwise, the camera's right is the rig's up.
  EXPECT_NEAR(r.y_mm[r.index(60, 20)], s.x_mm[s.index(60, 20)], 1e-3);
  pose = {};
  pose.moved_mm = {2, -1, 0};
  const CameraView bumped({64, 64}, lens(), pose, 60);
  EXPECT_NEAR(bumped.ground().x_mm[100] - s.x_mm[100], 2, 1e-4);
  EXPECT_NEAR(bumped.ground().y_mm[100] - s.y_mm[100], -1, 1e-4);
}

TEST(CameraView, OneThatSeesTheHorizonIsRefused) {
  CameraPose pose;
  pose.distant = false;
  pose.position_mm = {0, -300, 20};
  EXPECT_THROW(CameraView({64, 64}, noLens(), pose, 60), ProcessingError);
}

}  // namespace
}  // namespace patina::devices::twin
