// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/canvas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/processing/render/probe.h"

namespace patina::render {
namespace {

constexpr Colour kWhite{255, 255, 255}, kBlack{0, 0, 0};

TEST(Canvas, CoversExactlyTheAreaOfAShape) {
  Canvas canvas({100, 100}, kWhite);
  canvas.polygon({{10.25, 20.5}, {60.75, 20.5}, {60.75, 40.75}, {10.25, 40.75}}, kBlack);
  EXPECT_NEAR(inkIn(canvas.image()), 50.5 * 20.25, 1.0);
  EXPECT_NEAR(canvas.image().at(10, 30, 0), 255 * 0.25, 1.5);  // three quarters covered
  EXPECT_EQ(canvas.image().at(30, 30, 0), 0);
}

TEST(Canvas, CoversTheAreaOfTrianglesAndDiscsWhicheverWayTheyTurn) {
  for (const bool turned : {false, true}) {
    Canvas canvas({100, 100}, kWhite);
    std::vector<Point> corners{{12.3, 8.1}, {91.7, 33.3}, {40.2, 88.8}};
    if (turned) std::swap(corners[0], corners[1]);
    canvas.polygon(corners, kBlack);
    const double area = std::abs((91.7 - 12.3) * (88.8 - 8.1) - (40.2 - 12.3) * (33.3 - 8.1)) / 2;
    EXPECT_NEAR(inkIn(canvas.image()), area, area * 0.002);
  }
  Canvas canvas({60, 60}, kWhite);
  canvas.disc({30, 30}, 20, kBlack);
  EXPECT_NEAR(inkIn(canvas.image()), std::numbers::pi * 400, 4);
}

TEST(Canvas, DrawsALineOfItsWidthAndADashedOneOfHalf) {
  Canvas solid({200, 40}, kWhite), dashed({200, 40}, kWhite);
  solid.line({{10, 12.5}, {90, 22.5}, {190, 12.5}}, 2, kBlack);
  const double length = std::hypot(80, 10) + std::hypot(100, 10);
  EXPECT_NEAR(inkIn(solid.image()), 2 * length, 2 * length * 0.02);
  dashed.line({{10, 12.5}, {90, 22.5}, {190, 12.5}}, 2, kBlack, 5);
  EXPECT_NEAR(inkIn(dashed.image()), length, length * 0.06);
}

TEST(Canvas, KeepsClearOfItsBordersWhateverIsDrawn) {
  Canvas canvas({20, 10}, kWhite);
  canvas.line({{-50, -50}, {90, 40}}, 3, kBlack);
  canvas.disc({20, 10}, 8, kBlack);
  canvas.text({-5, 5}, "over the edge and on", {.size_px = 14});
  canvas.polygon({{NAN, 0}, {5, 5}, {0, 5}}, kBlack);
  canvas.line({{0, 0}, {INFINITY, 1}}, 1, kBlack);
  canvas.hatch({-5, -5, 100, 100}, kWhite, kBlack);
  canvas.picture(15, 5, Image<std::uint8_t>(10, 10, 3).view());
  canvas.picture(-5, -5, Image<std::uint8_t>(10, 10, 1).view());
  EXPECT_EQ(canvas.image().size(), (SizePx{20, 10}));
}

TEST(Canvas, BlendsByAlpha) {
  Canvas canvas({4, 4}, kWhite);
  canvas.box({0, 0}, {4, 4}, {0, 0, 0, 0.5});
  EXPECT_NEAR(canvas.image().at(2, 2, 1), 128, 1);
}

TEST(Canvas, AlignsTextAboutItsPoint) {
  const auto leftmost = [](Align align) {
    Canvas canvas({200, 30}, kWhite);
    canvas.text({100, 20}, "mmmm", {.size_px = 14, .colour = kBlack, .align = align});
    for (int x = 0; x < 200; ++x)
      for (int y = 0; y < 30; ++y)
        if (canvas.image().at(x, y, 0) < 128) return x;
    return -1;
  };
  EXPECT_GE(leftmost(Align::kLeft), 100);
  EXPECT_NEAR(leftmost(Align::kMiddle), 73, 2);
  EXPECT_LT(leftmost(Align::kRight), 60);
}

}  // namespace
}  // namespace patina::render
