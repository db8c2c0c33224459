// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_space.h"

#include <gtest/gtest.h>

namespace patina::calibration {
namespace {

TEST(Lab, OfWhiteIsAHundredAndOfNothingIsNone) {
  const Lab white = labOf(kD50), black = labOf({});
  EXPECT_NEAR(white.l, 100, 1e-12);
  EXPECT_NEAR(white.a, 0, 1e-12);
  EXPECT_NEAR(white.b, 0, 1e-12);
  EXPECT_NEAR(black.l, 0, 1e-12);
}

TEST(Lab, ComesBackFromXyzAlsoInTheDark) {
  for (const Lab lab : {Lab{50, 20, -30}, Lab{3, 1, -1}, Lab{96, -1, 3}, Lab{28, 15, -50}}) {
    const Lab back = labOf(xyzOf(lab));
    EXPECT_NEAR(back.l, lab.l, 1e-9);
    EXPECT_NEAR(back.a, lab.a, 1e-9);
    EXPECT_NEAR(back.b, lab.b, 1e-9);
  }
  EXPECT_NEAR(xyzOf({50, 0, 0}).y, 0.18418651851, 1e-9);  // ((50 + 16) / 116)^3
}

// B. Lindbloom's tables, for the same white points.
TEST(Bradford, IsThePublishedMatrixFromD65ToD50) {
  const Matrix3 published{1.0478112,  0.0228866,  -0.0501270, 0.0295424, 0.9904844,
                          -0.0170491, -0.0092345, 0.0150436,  0.7521316};
  const Matrix3 ours = bradford(kD65, kD50);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(ours[i], published[i], 1e-6) << i;
}

TEST(LinearSrgb, HasThePublishedPrimariesUnderD50) {
  const auto red = mapped(xyzFromLinearSrgb(), {1, 0, 0});
  EXPECT_NEAR(red[0], 0.4360747, 1e-6);
  EXPECT_NEAR(red[1], 0.2225045, 1e-6);
  EXPECT_NEAR(red[2], 0.0139322, 1e-6);
}

TEST(LinearSrgb, TakesTheWhiteOfD50ForOneOneOne) {
  for (const double v : mapped(linearSrgbFromXyz(), {kD50.x, kD50.y, kD50.z}))
    EXPECT_NEAR(v, 1, 1e-9);
}

}  // namespace
}  // namespace patina::calibration
