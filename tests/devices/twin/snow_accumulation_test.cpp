// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/specimen.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 240;
constexpr double kTexelMm = 120.0 / kSide;

// One specimen for all: preparing it costs more than looking at it.
SurfaceMaps snowAt(double time) {
  static const auto snow = makeSpecimen("snow_accumulation", 5);
  return snow->surfaceAt(time, {kSide, kSide});
}

bool isWhite(const SurfaceMaps& maps, int x, int y) { return maps.diffuse.at(x, y) > 0.3f; }

double whiteShare(const SurfaceMaps& maps) {
  double white = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) white += isWhite(maps, x, y);
  return white / (kSide * kSide);
}

TEST(SnowAccumulation, BeginsAsDryBluishSlateInLayers) {
  const SurfaceMaps maps = snowAt(0);
  EXPECT_EQ(whiteShare(maps), 0);
  EXPECT_GT(meanOf(maps.diffuse, 2), 1.1 * meanOf(maps.diffuse, 0)) << "bluish";
  EXPECT_LT(meanOf(maps.diffuse, 1), 0.2) << "dark";
  EXPECT_GT(meanOf(maps.roughness), 0.4) << "dry";
  const auto [low, high] =
      std::minmax_element(maps.height.texels().begin(), maps.height.texels().end());
  EXPECT_GT(*high - *low, 2) << "several layers";
}

TEST(SnowAccumulation, ScatteredClumpsMergeUntilAllIsWhite) {
  double before = 0;
  for (const double time : {0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9}) {
    const double now = whiteShare(snowAt(time));
    EXPECT_GT(now, before) << time;
    before = now;
  }
  EXPECT_LT(whiteShare(snowAt(0.1)), 0.1);
  EXPECT_GT(whiteShare(snowAt(0.5)), 0.3);
  EXPECT_LT(whiteShare(snowAt(0.5)), 0.75);
  EXPECT_EQ(whiteShare(snowAt(1)), 1);
}

// The wind comes from the upper left; a ledge there shelters.
TEST(SnowAccumulation, IsWhiteFirstInTheLeeOfLedges) {
  const Image<float> slate = snowAt(0).height;
  const SurfaceMaps some = snowAt(0.4);
  const int up = static_cast<int>(2.2 / kTexelMm), left = static_cast<int>(3.3 / kTexelMm);
  double lee = 0, lee_white = 0, luff = 0, luff_white = 0;
  for (int y = up; y < kSide; ++y)
    for (int x = left; x < kSide; ++x) {
      const float step = slate.at(x - left, y - up) - slate.at(x, y);
      if (step > 0.5f) {
        ++lee;
        lee_white += isWhite(some, x, y);
      } else if (step < -0.5f) {
        ++luff;
        luff_white += isWhite(some, x, y);
      }
    }
  ASSERT_GT(lee, 1000);
  ASSERT_GT(luff, 1000);
  EXPECT_GT(lee_white / lee, 1.5 * luff_white / luff);
}

TEST(SnowAccumulation, AClumpLandsWithinTwoPercentOfTheProcess) {
  const SurfaceMaps before = snowAt(0.20), after = snowAt(0.22);
  int landed = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      landed += after.diffuse.at(x, y) - before.diffuse.at(x, y) > 0.3f;
  EXPECT_GT(landed, 60);
}

TEST(SnowAccumulation, SlateIsDarkAndGlossyJustBeforeItIsCovered) {
  const SurfaceMaps dry = snowAt(0), wet = snowAt(0.45), soon = snowAt(0.48);
  int rim = 0;
  double rough = 0, darker = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      if (wet.diffuse.at(x, y, 2) >= dry.diffuse.at(x, y, 2) || !isWhite(soon, x, y)) continue;
      ++rim;
      rough += wet.roughness.at(x, y);
      darker += wet.diffuse.at(x, y) / dry.diffuse.at(x, y);
    }
  ASSERT_GT(rim, 50);
  EXPECT_LT(rough / rim, 0.3);
  EXPECT_LT(darker / rim, 0.7);
}

TEST(SnowAccumulation, GlossRisesAndFalls) {
  const double dry = meanOf(snowAt(0).roughness), white = meanOf(snowAt(1).roughness);
  const SurfaceMaps some = snowAt(0.4);
  double wet = 0, bare = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      if (!isWhite(some, x, y)) {
        ++bare;
        wet += some.roughness.at(x, y);
      }
  EXPECT_LT(wet / bare, 0.6 * dry);
  EXPECT_GT(white, 1.3 * dry);
}

TEST(SnowAccumulation, DriftsRiseBySeveralMillimetresAndAreSmooth) {
  const SurfaceMaps slate = snowAt(0), end = snowAt(1);
  EXPECT_GT(meanOf(end.height) - meanOf(slate.height), 3);
  double least = 99, most = 0, bend = 0, bend_of_slate = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 1; x < kSide; ++x) {
      const double depth = end.height.at(x, y) - slate.height.at(x, y);
      least = std::min(least, depth);
      most = std::max(most, depth);
      bend += std::abs(end.normal.at(x, y) - end.normal.at(x - 1, y));
      bend_of_slate += std::abs(slate.normal.at(x, y) - slate.normal.at(x - 1, y));
    }
  EXPECT_GT(most - least, 2) << "drifts";
  EXPECT_LT(bend, 0.85 * bend_of_slate);
}

// At a clump's edge the height jumps, elsewhere its slope is the normal's.
TEST(SnowAccumulation, NormalsAgreeWithHeights) {
  const auto snow = makeSpecimen("snow_accumulation", 5);
  const SampleGrid grid = SampleGrid::regular({512, 48}, snow->info().width_mm);
  const auto surface = snow->prepare(grid);
  for (const double time : {0.0, 0.4, 1.0}) {
    const SurfaceMaps maps = mapsAt(*surface, time, grid.size);
    int within = 0, close = 0;
    for (int y = 1; y < 47; ++y)
      for (int x = 1; x < 511; ++x) {
        const float dx =
            (maps.height.at(x + 1, y) - maps.height.at(x - 1, y)) / (2 * grid.texel_mm);
        const float dy =
            (maps.height.at(x, y - 1) - maps.height.at(x, y + 1)) / (2 * grid.texel_mm);
        if (std::hypot(dx, dy) > 0.8f) continue;
        ++within;
        const float nz = maps.normal.at(x, y, 2);
        close += std::hypot(dx + maps.normal.at(x, y, 0) / nz, dy + maps.normal.at(x, y, 1) / nz) <
                 0.15f;
      }
    EXPECT_GT(within, 0.7 * 46 * 510) << time;
    EXPECT_GT(close, 0.85 * within) << time;
  }
}

TEST(SnowAccumulation, IsWhiteWithATouchOfBlueInItsHollows) {
  const SurfaceMaps end = snowAt(1);
  EXPECT_GT(meanOf(end.diffuse, 1), 0.78);
  double bluest = 0, whitest = 1;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const double blue = end.diffuse.at(x, y, 2) - end.diffuse.at(x, y, 0);
      bluest = std::max(bluest, blue);
      whitest = std::min(whitest, blue);
    }
  EXPECT_GT(bluest, 0.12);
  EXPECT_LT(bluest, 0.25);
  EXPECT_LT(whitest, 0.06);
}

TEST(SnowAccumulation, DegreeRunsFromZeroToOneEverywhere) {
  const SurfaceMaps start = snowAt(0), end = snowAt(1);
  EXPECT_EQ(*std::max_element(start.degree.texels().begin(), start.degree.texels().end()), 0);
  EXPECT_GT(*std::min_element(end.degree.texels().begin(), end.degree.texels().end()), 0.9999f);
}

TEST(SnowAccumulation, HasNoGradientOverTheSpecimen) {
  const SurfaceMaps end = snowAt(1);
  double quarter[2][2] = {};
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      quarter[y / (kSide / 2)][x / (kSide / 2)] += end.height.at(x, y) * 4.0 / (kSide * kSide);
  for (const auto& row : quarter)
    for (const double q : row) EXPECT_NEAR(q, quarter[0][0], 1.5);
}

}  // namespace
}  // namespace patina::devices::twin
