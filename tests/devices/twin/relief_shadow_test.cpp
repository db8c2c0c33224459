// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/relief_shadow.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::devices::twin {
namespace {

LampPlace lampAt(double x, double y, double z, double radius_mm = 1) {
  LampPlace lamp;
  lamp.position_mm = {x, y, z};
  lamp.radius_mm = radius_mm;
  return lamp;
}

// A wall of `height_mm` along y, three texels thick, its left side at column `at` of a flat field
// of 0.1 mm texels.
ReliefShadow wall(int at, float height_mm) {
  ReliefShadow relief(0, 0, 20, 20, 0.1f);
  std::vector<float> heights(relief.grid().x_mm.size());
  for (int y = 0; y < relief.grid().size.height; ++y)
    heights[relief.grid().index(at, y)] = height_mm;
  relief.setHeights(std::move(heights));
  return relief;
}

TEST(ReliefShadow, OfAFlatFieldIsNone) {
  ReliefShadow relief(0, 0, 10, 10, 0.5f);
  relief.setHeights(std::vector<float>(relief.grid().x_mm.size(), 3.0f));
  for (const float seen : relief.visibility(lampAt(100, 40, 30))) EXPECT_EQ(seen, 1);
}

TEST(ReliefShadow, OfAWallIsAsLongAsTheLampIsLow) {
  // The lamp lies to the right, at half the slope: a wall of 2 mm shades 4 mm to its left.
  const ReliefShadow relief = wall(100, 2);
  const std::vector<float> seen = relief.visibility(lampAt(10 + 20'000, 10, 10'000));
  const auto at = [&](int column) { return seen[relief.grid().index(column, 100)]; };
  EXPECT_EQ(at(103), 1) << "towards the lamp";
  EXPECT_EQ(at(95), 0);
  EXPECT_EQ(at(65), 0);
  EXPECT_NEAR(at(62), 0.5, 0.5) << "the end of the shadow, 4 mm away";
  EXPECT_EQ(at(55), 1);
}

TEST(ReliefShadow, IsTheSameFromEverySide) {
  const float x0 = 0, x1 = 10;
  ReliefShadow relief(x0, x0, x1, x1, 0.1f);
  const int n = relief.grid().size.width;
  std::vector<float> post(relief.grid().x_mm.size());
  const int middle = n / 2;
  for (int y = -2; y <= 2; ++y)
    for (int x = -2; x <= 2; ++x) post[relief.grid().index(middle + x, middle + y)] = 1;
  relief.setHeights(post);
  const double cx = relief.grid().x_mm[relief.grid().index(middle, middle)],
               cy = relief.grid().y_mm[relief.grid().index(middle, middle)];
  const auto right = relief.visibility(lampAt(cx + 300, cy, 300)),
             left = relief.visibility(lampAt(cx - 300, cy, 300)),
             up = relief.visibility(lampAt(cx, cy + 300, 300)),
             down = relief.visibility(lampAt(cx, cy - 300, 300));
  const auto at = [&](const std::vector<float>& seen, int x, int y) {
    return seen[relief.grid().index(middle + x, middle + y)];
  };
  for (int far = 3; far < 20; ++far) {
    EXPECT_NEAR(at(right, -far, 1), at(left, far, 1), 1e-4) << far;
    EXPECT_NEAR(at(right, -far, 1), at(up, 1, far), 1e-4) << far;  // rows run down
    EXPECT_NEAR(at(right, -far, 1), at(down, 1, -far), 1e-4) << far;
  }
}

TEST(ReliefShadow, FallsAwayFromTheLamp) {
  ReliefShadow relief(0, 0, 10, 10, 0.1f);
  const int middle = relief.grid().size.width / 2;
  std::vector<float> post(relief.grid().x_mm.size());
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) post[relief.grid().index(middle + x, middle + y)] = 2;
  relief.setHeights(post);
  const double c = relief.grid().x_mm[middle];
  for (const auto& [right, up] : {std::pair{2, 1}, {-2, 1}, {1, -2}, {-1, -2}}) {
    const auto seen = relief.visibility(lampAt(c + 100 * right, 10 - c + 100 * up, 150));
    // Rows run down: the shadow of a lamp to the upper right lies to the lower left.
    EXPECT_LT(seen[relief.grid().index(middle - 5 * right, middle + 5 * up)], 0.3f) << right << up;
    EXPECT_EQ(seen[relief.grid().index(middle - 5 * right, middle - 5 * up)], 1) << right << up;
    EXPECT_EQ(seen[relief.grid().index(middle + 5 * right, middle + 5 * up)], 1) << right << up;
  }
}

TEST(ReliefShadow, APenumbraIsAsWideAsTheLampAndFarFromItsCause) {
  const auto width = [](double radius_mm) {
    const ReliefShadow relief = wall(150, 2);
    const std::vector<float> seen = relief.visibility(lampAt(15 + 400, 10, 200, radius_mm));
    int partly = 0;
    for (int x = 0; x < 150; ++x) {
      const float v = seen[relief.grid().index(x, 100)];
      partly += v > 0 && v < 1;
    }
    return partly;
  };
  EXPECT_GT(width(40), 3 * width(10));
  EXPECT_GT(width(10), 1);
}

TEST(ReliefShadow, GrowsNoBrighterWhereTheReliefRises) {
  ReliefShadow low = wall(100, 1), high = wall(100, 1.5f);
  const auto a = low.visibility(lampAt(300, 100, 120)), b = high.visibility(lampAt(300, 100, 120));
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      if (x < 100 || x > 102) {
        EXPECT_LE(b[low.grid().index(x, y)], a[low.grid().index(x, y)] + 1e-6f);
      }
}

TEST(GridReader, ReadsALinearFieldExactly) {
  const ReliefShadow from(-5, -5, 5, 5, 0.25f);
  std::vector<float> field;
  for (std::size_t k = 0; k < from.grid().x_mm.size(); ++k)
    field.push_back(2 * from.grid().x_mm[k] - 3 * from.grid().y_mm[k]);
  const SampleGrid to = SampleGrid::regular({33, 17}, 8);
  const GridReader reader(from.grid(), to);
  std::vector<float> row(33);
  for (int y = 0; y < 17; ++y) {
    reader.readRow(field, y, row.data());
    for (int x = 0; x < 33; ++x)
      EXPECT_NEAR(row[x], 2 * to.x_mm[to.index(x, y)] - 3 * to.y_mm[to.index(x, y)], 1e-4);
  }
}

}  // namespace
}  // namespace patina::devices::twin
