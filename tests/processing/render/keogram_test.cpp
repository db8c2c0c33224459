// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/keogram.h"

#include <gtest/gtest.h>

#include "processing/render/palette.h"
#include "tests/processing/render/probe.h"

namespace patina::render {
namespace {

constexpr Colour kRed{255, 0, 0}, kGreen{0, 255, 0};

KeogramLine line(double time_s, Colour colour, int height = 200) {
  KeogramLine out{time_s, Image<std::uint8_t>(1, height, 3)};
  for (int y = 0; y < height; ++y) {
    out.column.at(0, y, 0) = colour.r;
    out.column.at(0, y, 1) = colour.g;
    out.column.at(0, y, 2) = colour.b;
  }
  return out;
}

TEST(DrawKeogram, LaysLinesOutByTheirTime) {
  std::vector<KeogramLine> lines;
  for (int i = 0; i < 100; ++i) lines.push_back(line(i * 600, i < 30 ? kRed : kGreen));
  const auto image = drawKeogram(lines);
  EXPECT_NEAR(countNear(image, kRed), 0.3 * 1080 * 200, 1080 * 4);
  EXPECT_NEAR(countNear(image, kGreen), 0.7 * 1080 * 200, 1080 * 4);
}

TEST(DrawKeogram, HatchesAGapOfItsLength) {
  std::vector<KeogramLine> lines;
  for (int i = 0; i < 100; ++i)
    if (i < 50 || i >= 75) lines.push_back(line(i * 600, kRed));
  KeogramOptions options;
  options.interval_s = 600;
  const auto image = drawKeogram(lines, options);
  EXPECT_NEAR(countNear(image, kRed), 0.75 * 1080 * 200, 1080 * 4);
  EXPECT_GT(countNear(image, kMissingGround), 0.25 * 1080 * 200 / 3);
}

TEST(DrawKeogram, HasNoGapWhereLinesAreRegularWhateverTheirNumber) {
  for (const int n : {1, 2, 3, 1079, 5000}) {
    std::vector<KeogramLine> lines;
    for (int i = 0; i < n; ++i) lines.push_back(line(100 + i * 7.3, kRed, 160));
    EXPECT_EQ(countNear(drawKeogram(lines), kRed), 1080 * 160) << n;
  }
}

TEST(DrawKeogram, ShowsALaterEndAsAGap) {
  KeogramOptions options;
  options.interval_s = 10;
  options.end_s = 200;
  std::vector<KeogramLine> lines;
  for (int i = 0; i < 10; ++i) lines.push_back(line(i * 10, kRed));
  EXPECT_NEAR(countNear(drawKeogram(lines, options), kRed), 0.5 * 1080 * 200, 1080 * 2);
}

TEST(DrawKeogram, RefusesNoLinesDisorderAndUnequalHeights) {
  EXPECT_THROW(drawKeogram({}), ProcessingError);
  EXPECT_THROW(drawKeogram({line(5, kRed), line(3, kRed)}), ProcessingError);
  EXPECT_THROW(drawKeogram({line(1, kRed, 100), line(3, kRed, 101)}), ProcessingError);
}

TEST(KeogramColumn, AveragesLightAroundItsColumnAndStaysInside) {
  Image<std::uint8_t> frame(5, 2, 1);
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 5; ++x) frame.at(x, y) = x == 2 ? 255 : 0;
  const auto column = keogramColumn(frame.view(), 2, 1);
  EXPECT_EQ(column.size(), (SizePx{1, 2}));
  EXPECT_EQ(column.at(0, 1, 2), 255);
  EXPECT_EQ(keogramColumn(frame.view(), 2, 3).at(0, 0, 0), 156);  // a third of the light
  EXPECT_EQ(keogramColumn(frame.view(), 0, 1).at(0, 0, 0), 0);
  EXPECT_EQ(keogramColumn(frame.view(), 99, 3).height(), 2);
  EXPECT_EQ(keogramColumn(frame.view(), -9, 99).height(), 2);
}

}  // namespace
}  // namespace patina::render
