// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/displacement_grid.h"

#include <gtest/gtest.h>

namespace patina::calibration {
namespace {

// What a pixel says that wants to be displaced by (x, y), however much it is asked.
PixelSays wants(double x, double y, double how_much) {
  return {how_much, 0, how_much, how_much * x, how_much * y, how_much, 0, how_much};
}

TEST(DisplacementGrid, FindsAFieldThatIsBilinear) {
  Image<float> field(4, 3, 2);
  DisplacementGrid grid({4, 3}, 16);
  grid.add({49, 33}, [](int x, int y) { return wants(0.02 * x - 0.3, 0.01 * y + 0.5, 100); });
  grid.solve(field, field);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 4; ++i) {
      EXPECT_NEAR(field.at(i, j, 0), 0.02 * 16 * i - 0.3, 1e-3);
      EXPECT_NEAR(field.at(i, j, 1), 0.01 * 16 * j + 0.5, 1e-3);
    }
}

// Half of the slopes across and nearly all of those along are noise.
TEST(DisplacementGrid, CountsSlopesByWhatOfThemBothPicturesShow) {
  Image<float> field(3, 3, 2);
  DisplacementGrid grid({3, 3}, 16);
  grid.add({33, 33}, [](int, int) {
    const PixelSays across = wants(0, 0.4, 500);
    return PixelSays{1000, 0, 1000, 0, across.y, 0, 0, across.yy};
  });
  grid.add({33, 33}, [](int, int) { return wants(0.3, 0.4, 100); });
  grid.solve(field, field);
  EXPECT_NEAR(field.at(1, 1, 1), 0.4, 1e-3) << "not half of it";
  EXPECT_NEAR(field.at(1, 1, 0), 0.3, 0.03) << "held back by noise along the grain";
}

TEST(DisplacementGrid, GoesOnStraightWhereNothingIsSaid) {
  Image<float> field(6, 3, 2);
  DisplacementGrid grid({6, 3}, 16);
  grid.add({81, 33}, [](int x, int) { return x < 48 ? wants(0.05 * x, 0, 100) : PixelSays{}; });
  grid.solve(field, field);
  EXPECT_NEAR(field.at(5, 1, 0), 0.05 * 80, 0.05);
  EXPECT_NEAR(field.at(5, 1, 1), 0, 1e-3);
}

TEST(DisplacementGrid, KeepsTheBendingItHadWhereNothingIsSaid) {
  Image<float> start(5, 5, 2);
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) start.at(i, j, 0) = 0.3f * static_cast<float>(i * i - j * i);
  Image<float> field = start;
  DisplacementGrid grid({5, 5}, 8);
  grid.add({33, 33}, [](int, int) { return PixelSays{}; });
  grid.solve(start, field);
  EXPECT_EQ(field.texels(), start.texels());
}

}  // namespace
}  // namespace patina::calibration
