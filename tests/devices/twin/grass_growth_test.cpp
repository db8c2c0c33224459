// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/specimen.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 192;

// One specimen for all: preparing it costs more than looking at it.
SurfaceMaps grassAt(double time) {
  static const auto grass = makeSpecimen("grass_growth", 5);
  return grass->surfaceAt(time, {kSide, kSide});
}

bool isGreen(const SurfaceMaps& maps, int x, int y) {
  return maps.diffuse.at(x, y, 1) > 1.08f * maps.diffuse.at(x, y, 0);
}

double greenShare(const SurfaceMaps& maps, int y0 = 0, int y1 = kSide) {
  double green = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = 0; x < kSide; ++x) green += isGreen(maps, x, y);
  return green / (kSide * (y1 - y0));
}

TEST(GrassGrowth, BeginsAsDarkBrownSoilWithSeeds) {
  const SurfaceMaps maps = grassAt(0);
  EXPECT_LT(greenShare(maps), 1e-3);
  EXPECT_LT(meanOf(maps.diffuse, 0), 0.06) << "moist and dark";
  EXPECT_GT(meanOf(maps.diffuse, 0), 1.3 * meanOf(maps.diffuse, 2)) << "brown";
  double straw = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) straw += maps.diffuse.at(x, y, 0) > 0.15f;
  EXPECT_GT(straw / (kSide * kSide), 0.01);
  EXPECT_LT(straw / (kSide * kSide), 0.10);
}

TEST(GrassGrowth, CoversTheSoilOnlyLateAndAtEveryHeight) {
  double before = 0;
  for (const double time : {0.25, 0.35, 0.45, 0.6, 0.8}) {
    const double now = greenShare(grassAt(time));
    EXPECT_GT(now, before) << time;
    before = now;
  }
  const SurfaceMaps half = grassAt(0.35), end = grassAt(1);
  EXPECT_LT(greenShare(half), 0.6);
  EXPECT_GT(greenShare(end), 0.9);
  for (int y = 0; y < kSide; y += kSide / 4)
    EXPECT_GT(greenShare(end, y, y + kSide / 4), 0.85) << "no edge at row " << y;
}

// How far a texel resembles those so far away along an axis.
double likeness(const Image<float>& image, int dx, int dy) {
  const double mean = meanOf(image, 1);
  double product = 0, square = 0;
  for (int y = 0; y + dy < kSide; ++y)
    for (int x = 0; x + dx < kSide; ++x) {
      const double a = image.at(x, y, 1) - mean, b = image.at(x + dx, y + dy, 1) - mean;
      product += a * b;
      square += a * a;
    }
  return product / square;
}

TEST(GrassGrowth, BladesStandUpright) {
  const Image<float> soil = grassAt(0).diffuse, grass = grassAt(0.5).diffuse;
  EXPECT_LT(likeness(soil, 0, 8), 0.25);
  EXPECT_GT(likeness(grass, 0, 8), 0.35);
  EXPECT_GT(likeness(grass, 0, 8), 2 * likeness(grass, 8, 0));
}

TEST(GrassGrowth, TurnsFromYellowGreenToDeepGreen) {
  const auto rednessOfGreen = [](const SurfaceMaps& maps, double& green) {
    double red = 0, count = 0;
    green = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        if (isGreen(maps, x, y)) {
          red += maps.diffuse.at(x, y, 0);
          green += maps.diffuse.at(x, y, 1);
          ++count;
        }
    const double ratio = red / green;
    green /= count;
    return ratio;
  };
  double young_green = 0, old_green = 0;
  const double young = rednessOfGreen(grassAt(0.35), young_green);
  const double old = rednessOfGreen(grassAt(1), old_green);
  EXPECT_LT(old, 0.75 * young);
  EXPECT_LT(old_green, 0.5 * young_green);
}

TEST(GrassGrowth, RisesByManyMillimetresTowardTheCamera) {
  EXPECT_LT(std::abs(meanOf(grassAt(0).height)), 1.5);
  EXPECT_GT(meanOf(grassAt(0.6).height), 2);
  const SurfaceMaps end = grassAt(1);
  EXPECT_GT(meanOf(end.height), 4);
  EXPECT_GT(*std::max_element(end.height.texels().begin(), end.height.texels().end()), 8);
}

// At a blade's edge the height jumps, elsewhere its slope is the normal's.
TEST(GrassGrowth, NormalsAgreeWithHeights) {
  const auto grass = makeSpecimen("grass_growth", 5);
  const SampleGrid grid = SampleGrid::regular({512, 64}, grass->info().width_mm);
  const SurfaceMaps maps = mapsAt(*grass->prepare(grid), 0.8, grid.size);
  int within = 0, close = 0;
  for (int y = 1; y < 63; ++y)
    for (int x = 1; x < 511; ++x) {
      const float dx = (maps.height.at(x + 1, y) - maps.height.at(x - 1, y)) / (2 * grid.texel_mm);
      const float dy = (maps.height.at(x, y - 1) - maps.height.at(x, y + 1)) / (2 * grid.texel_mm);
      if (std::hypot(dx, dy) > 1.2f) continue;  // an edge
      ++within;
      const float nz = maps.normal.at(x, y, 2);
      close +=
          std::hypot(dx + maps.normal.at(x, y, 0) / nz, dy + maps.normal.at(x, y, 1) / nz) < 0.25f;
    }
  EXPECT_GT(within, 62 * 510 / 3);
  EXPECT_GT(close, 0.7 * within);
}

// Light from the side: one half of a blade's channel faces it, the other does not.
TEST(GrassGrowth, BladesTurnTheirHalvesBothWays) {
  const SurfaceMaps maps = grassAt(0.7);
  double left = 0, right = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      left += maps.normal.at(x, y, 0) < -0.2f;
      right += maps.normal.at(x, y, 0) > 0.2f;
    }
  EXPECT_GT(left / (kSide * kSide), 0.15);
  EXPECT_GT(right / (kSide * kSide), 0.15);
}

TEST(GrassGrowth, YoungLeavesShineMost) {
  EXPECT_LT(meanOf(grassAt(0.55).roughness), meanOf(grassAt(1).roughness) - 0.05);
}

TEST(GrassGrowth, DegreeIsTheLocalGrowthNotWhatCovers) {
  const SurfaceMaps start = grassAt(0), half = grassAt(0.5), end = grassAt(1);
  EXPECT_EQ(*std::max_element(start.degree.texels().begin(), start.degree.texels().end()), 0);
  EXPECT_GT(*std::min_element(end.degree.texels().begin(), end.degree.texels().end()), 0.9999f);
  float steepest = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 1; x < kSide; ++x)
      steepest = std::max(steepest, std::abs(half.degree.at(x, y) - half.degree.at(x - 1, y)));
  EXPECT_LT(steepest, 0.03f) << "smooth";
  const auto [least, most] =
      std::minmax_element(half.degree.texels().begin(), half.degree.texels().end());
  EXPECT_GT(*most - *least, 0.08f) << "some places are ahead";
}

TEST(GrassGrowth, ASproutMovesLittleFromFrameToFrame) {
  const Image<float> a = grassAt(0.6).diffuse, b = grassAt(0.602).diffuse;
  double difference = 0, sum = 0;
  for (std::size_t k = 0; k < a.texels().size(); ++k) {
    difference += std::abs(a.texels()[k] - b.texels()[k]);
    sum += a.texels()[k];
  }
  EXPECT_LT(difference / sum, 0.05);
  EXPECT_GT(difference, 0);
}

// A grid may be turned and reach beyond the square: the same place has the same truth.
TEST(GrassGrowth, APlaceIsTheSameInATurnedGrid) {
  const auto grass = makeSpecimen("grass_growth", 5);
  const SampleGrid straight = SampleGrid::regular({200, 40}, 50);
  SampleGrid turned;
  turned.size = {40, 200};
  turned.texel_mm = straight.texel_mm;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 40; ++x) {
      turned.x_mm.push_back(straight.x_mm[straight.index(y, x)]);
      turned.y_mm.push_back(straight.y_mm[straight.index(y, x)]);
    }
  const Image<float> a = mapsAt(*grass->prepare(straight), 0.7, straight.size).diffuse,
                     b = mapsAt(*grass->prepare(turned), 0.7, turned.size).diffuse;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 200; ++x) ASSERT_NEAR(a.at(x, y, 1), b.at(y, x, 1), 1e-4) << x << " " << y;
}

}  // namespace
}  // namespace patina::devices::twin
