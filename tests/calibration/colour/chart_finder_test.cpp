// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/chart_finder.h"

#include <gtest/gtest.h>

#include "calibration/failure.h"
#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

TEST(FindChart, FindsADrawnOneByItself) {
  Drawn drawn;
  drawn.corners = {{{130, 110}, {530, 138}, {515, 378}, {115, 350}}};
  Progress progress;
  const auto found = findChart(drawChart(drawn).view(), {}, progress);
  ASSERT_TRUE(found);
  EXPECT_LT(farthest(*found, drawn.corners), 6);
}

TEST(FindChart, GivesPixelsOfThePictureItWasGiven) {
  Drawn drawn;
  drawn.size = {1280, 960};
  for (PlacePx& corner : drawn.corners) corner = {corner.x * 2, corner.y * 2};
  Progress progress;
  const auto found = findChart(drawChart(drawn).view(), {.side_px = 640}, progress);
  ASSERT_TRUE(found);
  EXPECT_LT(farthest(*found, drawn.corners), 12);
}

TEST(FindChart, FindsNoneWhereThereIsNone) {
  Progress progress;
  Image<float> picture(640, 480, 3, 0.3F);
  EXPECT_FALSE(findChart(picture.view(), {}, progress));
  for (int y = 100; y < 200; ++y)
    for (int x = 100; x < 300; ++x) picture.at(x, y, 1) = 0.9F;
  EXPECT_FALSE(findChart(picture.view(), {}, progress));
}

TEST(FindChart, RefusesGreyPicturesAndOptionsOutOfRange) {
  Progress progress;
  EXPECT_THROW(findChart(Image<float>(64, 64, 1).view(), {}, progress), CalibrationError);
  EXPECT_THROW(findChart(Image<float>(64, 64, 3).view(), {.side_px = 10}, progress),
               CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
