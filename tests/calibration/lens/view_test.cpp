// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/view.h"

#include <gmock/gmock.h>

#include <cmath>

#include "tests/calibration/lens/twin_boards.h"

namespace patina::calibration {
namespace {

const Lens kLens{{640, 480}, 700, 705, 318, 243, -0.2, 0.05, 1e-3, -5e-4, 0};

// A camera at (30, -200, 350), looking down and a little to the north.
View slanted() {
  const double tilt = 0.5, c = std::cos(tilt), s = std::sin(tilt);
  View view;
  view.camera_from_plane = {1, 0, 0, 0, -c, -s, 0, s, -c};
  const double camera[3] = {30, -200, 350};
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k)
      view.plane_origin_mm[i] -= view.camera_from_plane[3 * i + k] * camera[k];
  return view;
}
PlaneSight sightOf(const View& view) {
  PlaneSight sight;
  for (int i = 0; i < 30; ++i) {
    const int column = i % 6, row = i / 6;
    sight.plane_mm.push_back({15.0 * column - 20, 12.0 * row - 30, 0});
  }
  sight.seen_px = project(kLens, view, sight.plane_mm);
  return sight;
}

TEST(View, OfPlacesOfThePlaneIsWhereTheCameraStands) {
  const ViewFit fit = fitView(kLens, sightOf(slanted()));
  EXPECT_NEAR(fit.report.camera_mm.x, 30, 1e-4);
  EXPECT_NEAR(fit.report.camera_mm.y, -200, 1e-4);
  EXPECT_NEAR(fit.report.camera_mm.z, 350, 1e-4);
  EXPECT_NEAR(fit.report.tilt_deg, 0.5 * 180 / M_PI, 1e-6);
  EXPECT_LT(fit.report.worst_px, 1e-6);
  EXPECT_EQ(fit.report.points, 30);
  EXPECT_NEAR(fit.report.mm_per_px, 350 / std::cos(0.5) / 700, 0.01);
}

TEST(View, GoesFromThePlaneToThePictureAndBack) {
  const std::vector<PointMm> places{{0, 0, 0}, {50, -30, 0}, {-40, 60, 0}};
  const std::vector<PointMm> back =
      planePlaces(kLens, slanted(), project(kLens, slanted(), places));
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_NEAR(back[i].x, places[i].x, 1e-5);
    EXPECT_NEAR(back[i].y, places[i].y, 1e-5);
  }
}

TEST(View, KnowsNothingOfPlacesFarOutsideThePicture) {
  const std::vector<PointMm> places{{0, 0, 0}, {5000, 0, 0}, {0, -4000, 0}};
  const std::vector<PlacePx> seen = project(kLens, slanted(), places);
  EXPECT_FALSE(std::isnan(seen[0].x));
  EXPECT_TRUE(std::isnan(seen[1].x)) << "there the polynomial folds back into the picture";
  EXPECT_TRUE(std::isnan(seen[2].x)) << "behind the camera";
}

TEST(View, IsRefusedWhenTheBoardIsNotTheOneTold) {
  PlaneSight sight = sightOf(slanted());
  for (PointMm& p : sight.plane_mm) p.x += 0.02 * p.x * p.x;
  try {
    fitView(kLens, sight);
    FAIL();
  } catch (const CalibrationError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("px (RMS"));
  }
  sight.plane_mm.resize(3);
  sight.seen_px.resize(3);
  EXPECT_THROW(fitView(kLens, sight), CalibrationError);
}

TEST(PlaneOf, TurnsABoardSoThatXRunsRightAndYUpWhicheverEndWasFoundFirst) {
  for (int turn = 0; turn < 4; ++turn) {
    BoardSight sight;
    const double c = std::cos(turn * M_PI / 2 + 0.2), s = std::sin(turn * M_PI / 2 + 0.2);
    for (int i = 0; i < 12; ++i) {
      const int column = i % 4, row = i / 4;
      const double x = column - 1.5, y = row - 1.0;
      sight.board_mm.push_back({x, y, 0});
      sight.seen_px.push_back({300 + 20 * (c * x - s * y), 200 + 20 * (s * x + c * y)});
    }
    const PlaneSight plane = planeOf(sight);
    for (std::size_t i = 0; i < plane.plane_mm.size(); ++i) {
      const double x = plane.plane_mm[i].x, y = -plane.plane_mm[i].y;
      EXPECT_NEAR(sight.seen_px[i].x, 300 + 20 * (std::cos(0.2) * x - std::sin(0.2) * y), 1e-9);
      EXPECT_NEAR(sight.seen_px[i].y, 200 + 20 * (std::sin(0.2) * x + std::cos(0.2) * y), 1e-9);
    }
  }
}

TEST(View, OfATwinsBoardFindsItsCameraToAThirdOfAPercentOfItsDistance) {
  constexpr SizePx kSize{480, 360};
  auto pose = testing::overhead(0, 1.4);
  pose.position_mm = {-60, -90, 200};
  pose.look_at_mm = {4, 2, 0};
  pose.roll_deg = 6;
  const auto board = testing::placed(testing::chessboard(10, 7, 9), {6, 4, 0}, {0, 0, 10});
  const auto sight = findBoard(greyOf(testing::shootTwin(kSize, pose, {board}).view()).view(),
                               {BoardSpec::kChessboard, 9, 6, 9, 0});
  ASSERT_TRUE(sight);
  const ViewFit fit = fitView(testing::trueLens(kSize, pose), planeOf(*sight));
  const double turn = 10 * M_PI / 180, c = std::cos(turn), s = std::sin(turn);
  const double x = -60 - 6, y = -90 - 4;  // from the board's middle
  const PointMm at = fit.report.camera_mm;
  const double off = std::sqrt(std::pow(at.x - (c * x + s * y), 2) +
                               std::pow(at.y - (c * y - s * x), 2) + std::pow(at.z - 200, 2));
  std::printf("camera found %.2f mm from where it stands, %.0f mm away; rms %.3f px\n", off,
              std::hypot(x, y, 200.0), fit.report.rms_px);
  EXPECT_LE(off, std::hypot(x, y, 200.0) / 300);
}

}  // namespace
}  // namespace patina::calibration
