// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {
namespace {

struct Means {
  double r = 0, g = 0, b = 0, rough = 0, degree = 0, dark = 0;  // dark: share of near-black texels
};
Means meansAt(const Specimen& specimen, double time, SizePx size = {192, 192}) {
  const SurfaceMaps maps = specimen.surfaceAt(time, size);
  Means m;
  const double n = static_cast<double>(size.width) * size.height;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      m.r += maps.diffuse.at(x, y, 0) / n;
      m.g += maps.diffuse.at(x, y, 1) / n;
      m.b += maps.diffuse.at(x, y, 2) / n;
      m.rough += maps.roughness.at(x, y) / n;
      m.degree += maps.degree.at(x, y) / n;
      m.dark += (maps.diffuse.at(x, y, 0) < 0.15) / n;
    }
  return m;
}

TEST(BananaRipening, GoesFromGreenThroughYellowToBrown) {
  const auto banana = makeSpecimen("banana_ripening", 5);
  const Means fresh = meansAt(*banana, 0), ripe = meansAt(*banana, 0.4), old = meansAt(*banana, 1);
  EXPECT_GT(fresh.g, fresh.r * 0.95) << "green-yellow";
  EXPECT_GT(ripe.r, ripe.g * 1.2);
  EXPECT_GT(ripe.g, ripe.b * 4) << "yellow";
  EXPECT_LT(old.r, ripe.r * 0.4) << "brown is dark";
  EXPECT_GT(old.r, old.g * 1.4);
}

TEST(BananaRipening, FrecklesAppearGrowAndMerge) {
  const auto banana = makeSpecimen("banana_ripening", 5);
  EXPECT_EQ(meansAt(*banana, 0.1).dark, 0);
  double before = 0;
  for (const double time : {0.4, 0.5, 0.6, 0.7, 0.8}) {
    const double now = meansAt(*banana, time).dark;
    EXPECT_GT(now, before) << time;
    before = now;
  }
  EXPECT_GT(before, 0.15);
  EXPECT_LT(before, 0.7);
}

TEST(BananaRipening, Roughens) {
  const auto banana = makeSpecimen("banana_ripening", 5);
  EXPECT_LT(meansAt(*banana, 0).rough, 0.35);
  EXPECT_GT(meansAt(*banana, 1).rough, 0.5);
}

TEST(BananaRipening, DegreeRunsFromZeroToOne) {
  const auto banana = makeSpecimen("banana_ripening", 5);
  EXPECT_EQ(meansAt(*banana, 0).degree, 0);
  EXPECT_GT(meansAt(*banana, 1).degree, 0.999);
}

TEST(BananaRipening, HasNoGradientOverTheSpecimen) {
  const auto banana = makeSpecimen("banana_ripening", 6);
  const SurfaceMaps maps = banana->surfaceAt(0.6, {192, 192});
  double quarter[2][2] = {};
  for (int y = 0; y < 192; ++y)
    for (int x = 0; x < 192; ++x)
      quarter[y / 96][x / 96] += maps.diffuse.at(x, y, 0) / (96.0 * 96.0);
  for (const auto& row : quarter)
    for (const double q : row) EXPECT_NEAR(q / quarter[0][0], 1, 0.2);
}

TEST(BananaRipening, AnotherSeedIsAnotherBananaOfTheSameKind) {
  const auto a = makeSpecimen("banana_ripening", 1), b = makeSpecimen("banana_ripening", 2);
  const Image<float> first = a->surfaceAt(0.6, {128, 128}).diffuse,
                     second = b->surfaceAt(0.6, {128, 128}).diffuse;
  double difference = 0;
  for (std::size_t k = 0; k < first.texels().size(); ++k)
    difference += std::abs(first.texels()[k] - second.texels()[k]);
  EXPECT_GT(difference / static_cast<double>(first.texels().size()), 0.02);
  EXPECT_NEAR(meansAt(*a, 0.6).r, meansAt(*b, 0.6).r, 0.08);
}

// A tile would show as a shift under which the picture correlates with itself.
TEST(BananaRipening, DoesNotRepeat) {
  const auto banana = makeSpecimen("banana_ripening", 8);
  const int n = 256;
  const Image<float> d = banana->surfaceAt(0.65, {n, n}).diffuse;
  double mean = 0, variance = 0;
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) mean += d.at(x, y, 0) / (n * n);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) variance += std::pow(d.at(x, y, 0) - mean, 2) / (n * n);
  double worst = 0;
  for (int shift = 48; shift <= 160; ++shift)
    for (const auto& [sx, sy] :
         {std::pair{shift, 0}, std::pair{0, shift}, std::pair{shift, shift}}) {
      double product = 0;
      for (int y = 0; y + sy < n; y += 2)
        for (int x = 0; x + sx < n; x += 2)
          product += (d.at(x, y, 0) - mean) * (d.at(x + sx, y + sy, 0) - mean);
      const double pairs = ((n - sx + 1) / 2) * ((n - sy + 1) / 2);
      worst = std::max(worst, product / pairs / variance);
    }
  EXPECT_LT(worst, 0.35);
}

}  // namespace
}  // namespace patina::devices::twin
