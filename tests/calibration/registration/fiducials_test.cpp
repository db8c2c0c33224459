// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/fiducials.h"

#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "calibration/failure.h"

namespace patina::calibration {
namespace {

// The markers 0 and 1 of ArUco's 4x4_50, black border included, 1 = white.
constexpr std::array<std::array<int, 16>, 2> kMarkers{
    {{1, 0, 1, 1, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0},
     {0, 0, 0, 0, 1, 1, 1, 1, 1, 0, 0, 1, 1, 0, 1, 0}}};

void draw(Image<float>& picture, int which, int left, int top, int cell_px) {
  for (int y = 0; y < 6 * cell_px; ++y)
    for (int x = 0; x < 6 * cell_px; ++x) {
      const int i = x / cell_px - 1, j = y / cell_px - 1;
      const bool inside = i >= 0 && j >= 0 && i < 4 && j < 4;
      const bool white =
          inside &&
          kMarkers[static_cast<std::size_t>(which)][static_cast<std::size_t>(4 * j + i)] != 0;
      picture.at(left + x, top + y) = white ? 0.8f : 0.03f;
    }
}

TEST(Fiducials, MarkersAreFoundWithHalfOfTheirSideAroundThem) {
  Image<float> picture(320, 240, 1, 0.7f);
  draw(picture, 0, 40, 40, 8);
  EXPECT_THROW(markersIn(picture.view()), CalibrationError) << "one is not enough";
  draw(picture, 1, 220, 150, 8);
  EXPECT_EQ(countMarkers(picture.view()), 2);
  const Image<std::uint8_t> mask = markersIn(picture.view());
  EXPECT_EQ(mask.at(64, 64), 255);
  EXPECT_EQ(mask.at(22, 64), 255) << "its surroundings";
  EXPECT_EQ(mask.at(8, 64), 0);
  EXPECT_EQ(mask.at(244, 174), 255);
  EXPECT_EQ(mask.at(160, 120), 0);
}

TEST(Fiducials, RectanglesLieWithinThePicture) {
  const std::array<RectPx, 2> two{{{0, 0, 4, 4}, {10, 12, 2, 3}}};
  const Image<std::uint8_t> mask = maskOf(two, {16, 16});
  EXPECT_EQ(mask.at(3, 3), 255);
  EXPECT_EQ(mask.at(4, 3), 0);
  EXPECT_EQ(mask.at(11, 14), 255);
  const std::array<RectPx, 1> beyond{{{10, 12, 7, 3}}};
  EXPECT_THROW(maskOf(beyond, {16, 16}), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
