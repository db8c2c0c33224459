// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lens/board.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/lens/twin_boards.h"

namespace patina::calibration {
namespace {

using testing::charuco, testing::chessboard, testing::placed;

constexpr SizePx kSize{480, 360};

BoardSpec corners(int columns, int rows) { return {BoardSpec::kChessboard, columns, rows, 6, 0}; }
BoardSpec charucoOf(int columns, int rows) { return {BoardSpec::kCharuco, columns, rows, 10, 7.5}; }

// RMS distance of found corners from where the twin's camera sees the target's own points.
double errorPx(const BoardSight& sight, const devices::TargetSpec& target, const Lens& lens,
               double height_mm) {
  double sum = 0;
  std::vector<PlacePx> straight;
  for (const PointMm& p : sight.board_mm) {
    const auto at = devices::twin::targetPoint(
        target, 0.5 + p.x / target.width_mm,
        0.5 + p.y / (target.width_mm * devices::twin::targetAspect(target)));
    straight.push_back({at.x / (height_mm - at.z) * lens.fx + lens.cx,
                        -at.y / (height_mm - at.z) * lens.fy + lens.cy});
  }
  const std::vector<PlacePx> expected = distorted(lens, straight);
  for (std::size_t i = 0; i < expected.size(); ++i)
    sum += std::pow(expected[i].x - sight.seen_px[i].x, 2) +
           std::pow(expected[i].y - sight.seen_px[i].y, 2);
  return std::sqrt(sum / static_cast<double>(expected.size()));
}

TEST(Board, ChessboardCornersAreFoundToATwentiethOfAPixelUnderNoise) {
  const auto pose = testing::overhead(220, 1.4);
  const auto target = placed(chessboard(10, 7, 6), {4, 6, 12}, {12, 10, 8});
  const Image<float> picture = testing::shootTwin(kSize, pose, {target});
  const auto sight = findBoard(greyOf(picture.view()).view(), corners(9, 6));
  ASSERT_TRUE(sight);
  ASSERT_EQ(sight->seen_px.size(), 54u);
  EXPECT_LT(errorPx(*sight, target, testing::trueLens(kSize, pose), 220), 0.05);
}

TEST(Board, CharucoCornersKeepTheirPlacesWhenPartOfTheBoardIsOutside) {
  const auto pose = testing::overhead(220, 1.4);
  const auto target = placed(charuco(7, 5, 10), {45, 10, 5}, {10, -8, 20});
  const Image<float> picture = testing::shootTwin(kSize, pose, {target});
  const auto sight = findBoard(greyOf(picture.view()).view(), charucoOf(7, 5));
  ASSERT_TRUE(sight);
  EXPECT_GE(sight->seen_px.size(), 8u);
  EXPECT_LT(sight->seen_px.size(), 24u) << "some are outside";
  EXPECT_LT(errorPx(*sight, target, testing::trueLens(kSize, pose), 220), 0.12);
}

TEST(Board, IsNotFoundWhereThereIsNone) {
  const Image<float> picture = testing::shootTwin({240, 180}, testing::overhead(220, 1.4), {});
  EXPECT_FALSE(findBoard(greyOf(picture.view()).view(), corners(9, 6)));
  EXPECT_FALSE(findBoard(greyOf(picture.view()).view(), charucoOf(7, 5)));
}

TEST(Board, OfAnotherSizeThanToldIsNamed) {
  const auto pose = testing::overhead(220, 1.4);
  std::vector<Image<float>> pictures;
  for (const double turn : {-6.0, 9.0})
    pictures.push_back(
        greyOf(testing::shootTwin({320, 240}, pose,
                                  {placed(chessboard(8, 6, 8), {0, 5, 10}, {10, turn, turn})})
                   .view()));
  const auto named = [&](int columns, int rows, bool larger) {
    const auto shown = boardShown(pictures, corners(columns, rows), larger);
    return shown ? describe(*shown) : "none";
  };
  EXPECT_EQ(named(8, 6, false), "7x5 inner corners") << "squares were counted";
  EXPECT_EQ(named(6, 5, true), "7x5 inner corners");
  EXPECT_EQ(named(7, 5, true), "none");
}

TEST(Board, RefusesSizesThatNoBoardHas) {
  EXPECT_THROW(corners(2, 6).check(), CalibrationError);
  BoardSpec wide = charucoOf(7, 5);
  wide.marker_mm = 10;
  EXPECT_THROW(wide.check(), CalibrationError);
  EXPECT_THROW(charucoOf(60, 60).check(), CalibrationError);
}

TEST(GreyOf, BringsADarkPictureUpToTheRange) {
  Image<float> dark(20, 20, 3, 0.01f);
  for (int c = 0; c < 3; ++c) dark.at(3, 3, c) = 0.001f;
  const Image<float> grey = greyOf(dark.view());
  EXPECT_NEAR(grey.at(10, 10), 0.9, 1e-5);
  EXPECT_NEAR(grey.at(3, 3), 0.09, 1e-5);
}

}  // namespace
}  // namespace patina::calibration
