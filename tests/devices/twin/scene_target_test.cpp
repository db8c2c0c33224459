// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/scene_target.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::devices::twin {
namespace {

TargetSpec target(TargetSpec::Kind kind, double width_mm) {
  TargetSpec t;
  t.kind = kind;
  t.width_mm = width_mm;
  return t;
}

// A picture under one lamp far above, of targets on black.
std::vector<float> picture(const std::vector<TargetSpec>& targets, const CameraView& view) {
  LampPlace lamp;
  lamp.position_mm = {0, 0, 1e6};
  std::vector<float> light(view.ground().x_mm.size());
  TargetPixels(targets, view).draw(lamp, light);
  return light;
}

CameraView lensless(SizePx size, double width_mm) {
  LensProfile lens;
  lens.focal_length = 1.2;
  return CameraView(size, lens, {}, width_mm);
}

TEST(Targets, AGreyCardIsAsBrightAsItsReflectanceAndAsLargeAsItIs) {
  const CameraView view = lensless({60, 60}, 60);  // 1 mm a pixel
  TargetSpec card = target(TargetSpec::kGreyCard, 20.5);
  card.position_mm = {5, -5, 0};
  card.reflectance = 0.4;
  const std::vector<float> light = picture({card}, view);
  EXPECT_NEAR(light[view.ground().index(35, 35)], 0.4, 1e-5);
  EXPECT_EQ(light[view.ground().index(10, 35)], 0);
  double area = 0;
  for (const float v : light) area += v / 0.4;
  EXPECT_NEAR(area, 20.5 * 20.5, 1) << "its rim is shared between pixels";
}

TEST(Targets, ATurnedCardIsForeshortenedAndShaded) {
  const CameraView view = lensless({120, 120}, 60);
  TargetSpec card = target(TargetSpec::kGreyCard, 20);
  card.position_mm = {0, 0, 15};
  card.rotation_deg = {60, 0, 0};
  const std::vector<float> light = picture({card}, view);
  EXPECT_NEAR(light[view.ground().index(60, 60)], 0.36 * 0.5, 1e-3);
  EXPECT_GT(light[view.ground().index(60, 60 - 9)], 0);
  EXPECT_EQ(light[view.ground().index(60, 60 - 12)], 0) << "half as high as it is wide";
  EXPECT_GT(light[view.ground().index(60 - 18, 60)], 0);
}

TEST(Targets, AChartHasItsFieldsWhereTheMakerPutThem) {
  const TargetSpec chart = target(TargetSpec::kColorChecker, 60);
  const auto field = [&](int column, int row) {
    return targetReflectance(chart, (column + 0.5) / 6, (row + 0.5) / 4);
  };
  EXPECT_NEAR(field(0, 3)[1], 0.90, 0.02) << "white";
  EXPECT_NEAR(field(3, 3)[1], 0.195, 0.01) << "neutral 5";
  EXPECT_NEAR(field(5, 3)[1], 0.034, 0.005) << "black";
  EXPECT_GT(field(2, 2)[0], 4 * field(2, 2)[1]) << "red";
  EXPECT_GT(field(0, 2)[2], 3 * field(0, 2)[0]) << "blue";
  EXPECT_NEAR(targetReflectance(chart, 0.001, 0.5)[0], 0.03, 1e-6) << "its frame";
}

TEST(Targets, ABoardsCornersLieWhereItsPoseSays) {
  TargetSpec board = target(TargetSpec::kChessboard, 70);
  board.columns = 7;
  board.rows = 5;
  board.position_mm = {3, 4, 10};
  board.rotation_deg = {0, 0, 90};
  EXPECT_EQ(targetReflectance(board, 0.01, 0.01)[0], 0.04);
  EXPECT_EQ(targetReflectance(board, 1.5 / 7, 0.01)[0], 0.85);
  // One square right and one down of its upper left corner, turned counterclockwise.
  const Point corner = targetPoint(board, 1.0 / 7, 1.0 / 5);
  EXPECT_NEAR(corner.x, 3 - (25 - 10), 1e-9);
  EXPECT_NEAR(corner.y, 4 - (35 - 10), 1e-9);
  EXPECT_NEAR(corner.z, 10, 1e-9);
}

TEST(Targets, ACharucoBoardHasTheMarkersOfItsDictionary) {
  TargetSpec board = target(TargetSpec::kCharuco, 70);
  board.columns = 7;
  board.rows = 5;
  const auto white = [&](int column, int row, double x, double y) {
    return targetReflectance(board, (column + x) / 7, (row + y) / 5)[0] > 0.5;
  };
  EXPECT_FALSE(white(0, 0, 0.5, 0.5)) << "a black square";
  EXPECT_TRUE(white(1, 0, 0.05, 0.5)) << "the white rim";
  EXPECT_FALSE(white(1, 0, 0.15, 0.5)) << "the marker's own rim";
  // Marker 0 is 1011 0101 0011 0010, in cells of an eighth of the square from a quarter on.
  const bool first[4][4] = {{1, 0, 1, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {0, 0, 1, 0}};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 4; ++x)
      EXPECT_EQ(white(1, 0, 0.25 + (x + 0.5) / 8, 0.25 + (y + 0.5) / 8), first[y][x]) << x << y;
  // The third row's first white square is the eighth: c4f2 begins 1100.
  EXPECT_TRUE(white(1, 2, 0.4375, 0.3125));
  EXPECT_FALSE(white(1, 2, 0.5625, 0.3125));
}

TEST(Targets, AMirrorSphereShowsTheLampHalfwayToIt) {
  const CameraView view = lensless({400, 400}, 40);
  TargetSpec sphere = target(TargetSpec::kMirrorSphere, 30);
  sphere.position_mm = {0, 0, 15};
  sphere.reflectance = 0.9;
  LampPlace lamp;
  lamp.position_mm = {3e5, 4e5, 5e5 * std::sqrt(3.0)};  // 30 degrees from the axis
  std::vector<float> light(view.ground().x_mm.size());
  TargetPixels({sphere}, view).draw(lamp, light);
  double sum = 0, x = 0, y = 0;
  for (std::size_t k = 0; k < light.size(); ++k) {
    sum += light[k];
    x += light[k] * view.ground().x_mm[k];
    y += light[k] * view.ground().y_mm[k];
  }
  // The normal is turned by half the angle: 15 mm times the sine of 15 degrees.
  const double away = 15 * std::sin(radians(15));
  EXPECT_NEAR(x / sum, away * 0.6, 0.05);
  EXPECT_NEAR(y / sum, away * 0.8, 0.05);
}

TEST(Targets, TheNearerOneHidesTheOther) {
  TargetSpec low = target(TargetSpec::kGreyCard, 20), high = low;
  high.position_mm = {0, 0, 30};
  high.reflectance = 0.1;
  const TargetHit hit = firstHit({low, high}, {{0, 0, 1000}, {0, 0, -1}});
  EXPECT_NEAR(hit.reflectance[0], 0.1, 1e-9);
  EXPECT_EQ(firstHit({low}, {{50, 0, 1000}, {0, 0, -1}}).target, nullptr);
}

}  // namespace
}  // namespace patina::devices::twin
