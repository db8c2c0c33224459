// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_refine.h"

#include <gtest/gtest.h>

#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

TEST(RefineCorners, BringsCornersThatAreEightPixelsOffToAFifthOfAPixel) {
  Drawn drawn;
  drawn.corners = {{{130, 110}, {530, 138}, {515, 378}, {115, 350}}};  // turned and sheared
  ChartCorners off = drawn.corners;
  off[0].x += 8, off[1].y -= 6, off[2].x -= 5, off[3].y += 7;
  const ChartCorners found = refineCorners(drawChart(drawn).view(), off);
  EXPECT_LT(farthest(found, drawn.corners), 0.2);
}

TEST(RefineCorners, LeavesThemWhereNoFieldStandsOut) {
  const Drawn drawn;
  const Image<float> grey(640, 480, 3, 0.4F);
  EXPECT_EQ(farthest(refineCorners(grey.view(), drawn.corners), drawn.corners), 0);
}

TEST(RefineCorners, LeavesThemWhereTheFieldsLieOnNoSuchGrid) {
  Drawn drawn;
  drawn.corners = {{{120, 120}, {520, 120}, {520, 360}, {120, 360}}};
  ChartCorners elsewhere = drawn.corners;
  for (PlacePx& corner : elsewhere) corner = {corner.x / 1.6 + 100, corner.y / 1.3 + 20};
  EXPECT_EQ(farthest(refineCorners(drawChart(drawn).view(), elsewhere), elsewhere), 0);
}

}  // namespace
}  // namespace patina::calibration
