// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/rectification.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/lens/twin_boards.h"

namespace patina::calibration {
namespace {

// A pinhole straight above the origin: `px_per_mm` on the plane.
struct Overhead {
  Lens lens{{640, 480}, 1000, 1000, 319.5, 239.5, 0, 0, 0, 0, 0};
  View view{{1, 0, 0, 0, -1, 0, 0, 0, -1}, {0, 0, 250}};  // 4 px a mm
};

TEST(Rectification, PutsTexelsWhereTheirMillimetresAre) {
  const Overhead camera;
  const PixelMap map = rectification(camera.lens, camera.view, {{-10, -5, 30, 20}, 2});
  EXPECT_EQ(map.size(), (SizePx{60, 40}));
  // Texel (0, 0) is the upper left one: its middle lies at (-9.75, 14.75) mm.
  EXPECT_NEAR(map.source_px.at(0, 0, 0), 319.5 - 4 * 9.75, 1e-3);
  EXPECT_NEAR(map.source_px.at(0, 0, 1), 239.5 - 4 * 14.75, 1e-3);
  EXPECT_NEAR(map.source_px.at(59, 39, 0), 319.5 + 4 * 19.75, 1e-3);
  EXPECT_NEAR(map.source_px.at(59, 39, 1), 239.5 + 4 * 4.75, 1e-3);
  EXPECT_NEAR(meanStep(map), 2, 1e-3);
}

TEST(Rectification, OffersTheRegionAndTheResolutionThatThePictureHas) {
  const Overhead camera;
  const RegionMm region = seenRegion(camera.lens, camera.view);
  EXPECT_NEAR(region.left, -319.5 / 4, 1e-6);
  EXPECT_NEAR(region.height, 479.0 / 4, 1e-6);
  EXPECT_NEAR(naturalTexelsPerMm(camera.lens, camera.view, region), 4, 1e-6);
}

TEST(Rectification, LeavesNoTexelOfTheSeenRegionUnseenHoweverTheCameraLeans) {
  Overhead camera;
  camera.lens.k1 = -0.12;
  camera.lens.k2 = 0.03;
  const double c = std::cos(0.6), s = std::sin(0.6);
  camera.view.camera_from_plane = {1, 0, 0, 0, -c, -s, 0, s, -c};
  const RegionMm region = seenRegion(camera.lens, camera.view);
  EXPECT_GT(region.width, 80);
  const PixelMap map = rectification(camera.lens, camera.view, {region, 1});
  for (int y = 0; y < map.size().height; ++y)
    for (int x = 0; x < map.size().width; ++x) {
      ASSERT_GE(map.source_px.at(x, y, 0), -0.5);
      ASSERT_LE(map.source_px.at(x, y, 0), 639.5);
      ASSERT_GE(map.source_px.at(x, y, 1), -0.5);
      ASSERT_LE(map.source_px.at(x, y, 1), 479.5);
    }
}

TEST(Rectification, IsRefusedForTexturesNobodyCanHold) {
  EXPECT_THROW((RectifyOptions{{0, 0, 100, 100}, 1000}.check()), CalibrationError);
  EXPECT_THROW((RectifyOptions{{0, 0, 0, 100}, 1}.check()), CalibrationError);
  EXPECT_THROW((RectifyOptions{{0, 0, 10, 10}, 0}.check()), CalibrationError);
  const Overhead camera;
  EXPECT_THROW(naturalTexelsPerMm(camera.lens, camera.view, {9000, 0, 10, 10}), CalibrationError);
}

TEST(Rectification, OfATwinsBoardIsAStraightBoardToATenthOfATexel) {
  constexpr SizePx kSize{480, 360};
  auto pose = testing::overhead(0, 1.4);
  pose.position_mm = {50, -80, 190};
  pose.look_at_mm = {2, 3, 0};
  const auto board = testing::placed(testing::chessboard(10, 7, 9), {6, 4, 0}, {0, 0, -7});
  const Image<float> picture = testing::shootTwin(kSize, pose, {board});
  const BoardSpec told{BoardSpec::kChessboard, 9, 6, 9, 0};
  const auto sight = findBoard(greyOf(picture.view()).view(), told);
  ASSERT_TRUE(sight);
  const Lens lens = testing::trueLens(kSize, pose);
  const ViewFit fit = fitView(lens, planeOf(*sight));
  const double texels_per_mm = naturalTexelsPerMm(lens, fit.view, {-36, -22.5, 72, 45});
  const RectifyOptions options{{-50, -36, 100, 72}, texels_per_mm};
  Image<float> texture = resample(picture.view(), rectification(lens, fit.view, options), 0.3f);
  const auto straight = findBoard(greyOf(texture.view()).view(), told);
  ASSERT_TRUE(straight);
  const PlaneSight plane = planeOf(*straight);
  double square = 0;
  for (std::size_t i = 0; i < plane.plane_mm.size(); ++i) {
    const double x = (plane.plane_mm[i].x + 50) * texels_per_mm - 0.5,
                 y = (36 - plane.plane_mm[i].y) * texels_per_mm - 0.5;
    square += std::pow(plane.seen_px[i].x - x, 2) + std::pow(plane.seen_px[i].y - y, 2);
  }
  const double rms = std::sqrt(square / static_cast<double>(plane.plane_mm.size()));
  std::printf(
      "corners of the rectified board: %.3f texels RMS from their millimetres, %.2f texels a mm\n",
      rms, texels_per_mm);
  EXPECT_LE(rms, 0.1);
}

}  // namespace
}  // namespace patina::calibration
