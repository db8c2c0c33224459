// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "devices/twin/specimen.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 224;

const Specimen& steel() {
  static const auto once = makeSpecimen("steel_rusting", 5);
  return *once;
}
SurfaceMaps steelAt(double time) { return steel().surfaceAt(time, {kSide, kSide}); }

bool isCrust(const SurfaceMaps& maps, int x, int y) {
  return maps.roughness.at(x, y) > 0.74f && maps.specular.at(x, y, 0) < 0.07f;
}
double crustShare(const SurfaceMaps& maps) {
  double share = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) share += isCrust(maps, x, y);
  return share / (kSide * kSide);
}

TEST(SteelRusting, BeginsAsBrightMetalGroundAlongX) {
  const SurfaceMaps maps = steelAt(0);
  EXPECT_GT(meanOf(maps.specular, 1), 0.45);
  EXPECT_LT(meanOf(maps.diffuse, 0), 0.1);
  EXPECT_LT(meanOf(maps.roughness), 0.4);
  double along = 0, across = 0;
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      along += std::abs(maps.specular.at(x + 1, y, 0) - maps.specular.at(x, y, 0));
      across += std::abs(maps.specular.at(x, y + 1, 0) - maps.specular.at(x, y, 0));
    }
  EXPECT_GT(across, 4 * along);
}

TEST(SteelRusting, PitsSeedSpreadAndMerge) {
  const auto spots = [](const SurfaceMaps& maps) {  // beginnings of spots along rows
    double count = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 1; x < kSide; ++x) count += isCrust(maps, x, y) && !isCrust(maps, x - 1, y);
    return count;
  };
  const SurfaceMaps few = steelAt(0.2), many = steelAt(0.55), merged = steelAt(1);
  EXPECT_LT(crustShare(few), 0.05);
  EXPECT_GT(spots(many), 4 * spots(few));
  EXPECT_GT(crustShare(merged) / spots(merged), 3 * crustShare(many) / spots(many))
      << "fewer, wider ones";
}

TEST(SteelRusting, TheShareOfRustRisesSharplyInTheMiddleOfTheProcess) {
  EXPECT_EQ(crustShare(steelAt(0.02)), 0);
  const double early = crustShare(steelAt(0.3)), middle = crustShare(steelAt(0.8)),
               end = crustShare(steelAt(1));
  EXPECT_GT(middle - early, 5 * early);
  EXPECT_GT(middle - early, 2 * (end - middle));
  EXPECT_GT(end, 0.6);
  EXPECT_LT(end, 0.98) << "some hazy metal stays";
}

TEST(SteelRusting, HazeComesEvenlyBesideThePits) {
  // Reflectance of what is no crust, by quarters of the picture.
  const auto quarters = [](const SurfaceMaps& maps) {
    std::array<double, 4> sum{}, n{};
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (isCrust(maps, x, y)) continue;
        const int q = 2 * (y / (kSide / 2)) + x / (kSide / 2);
        sum[q] += maps.specular.at(x, y, 0);
        ++n[q];
      }
    for (std::size_t q = 0; q < 4; ++q) sum[q] /= n[q];
    return sum;
  };
  const auto fresh = quarters(steelAt(0)), half = quarters(steelAt(0.55));
  for (std::size_t q = 0; q < 4; ++q) {
    EXPECT_LT(half[q], 0.9 * fresh[q]);
    EXPECT_GT(half[q], 0.5 * fresh[q]);
  }
}

TEST(SteelRusting, ColourOfASpotGoesFromOrangeToRedBrownToDark) {
  const SurfaceMaps seen = steelAt(0.25);
  const auto colourAt = [&](double time) {
    const SurfaceMaps maps = steelAt(time);
    std::array<double, 3> sum{};
    double n = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (!isCrust(seen, x, y)) continue;
        for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += maps.diffuse.at(x, y, c);
        ++n;
      }
    for (double& v : sum) v /= n;
    return sum;
  };
  const auto young = colourAt(0.25), older = colourAt(0.5), old = colourAt(1);
  EXPECT_GT(young[0], 0.25);
  EXPECT_GT(young[0], 2 * young[1]) << "orange";
  EXPECT_GT(young[1], 2 * young[2]);
  EXPECT_LT(older[0], 0.8 * young[0]);
  EXPECT_GT(older[0], 2.2 * older[1]) << "red-brown";
  EXPECT_LT(old[0], 0.5 * older[0]) << "dark";
}

TEST(SteelRusting, StainsRunDown) {
  // What is stained but no crust: taller than wide.
  const SurfaceMaps fresh = steelAt(0), maps = steelAt(0.5);
  double tall = 0, wide = 0, share = 0;
  const auto stained = [&](int x, int y) {
    return !isCrust(maps, x, y) && maps.diffuse.at(x, y, 0) - maps.diffuse.at(x, y, 2) > 0.10f;
  };
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      share += stained(x, y);
      tall += stained(x, y) && stained(x, y + 1);
      wide += stained(x, y) && stained(x + 1, y);
    }
  EXPECT_GT(share / (kSide * kSide), 0.01);
  EXPECT_GT(tall, 1.15 * wide);
}

TEST(SteelRusting, MetalBecomesAMattCrustThatStandsUp) {
  const SurfaceMaps fresh = steelAt(0), end = steelAt(1);
  EXPECT_LT(meanOf(end.specular), 0.12 * meanOf(fresh.specular) + 0.03);
  EXPECT_GT(meanOf(end.roughness), 0.75);
  double crust = 0, bare = 0, crusts = 0, bares = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      (isCrust(end, x, y) ? crust : bare) += end.height.at(x, y),
          ++(isCrust(end, x, y) ? crusts : bares);
  EXPECT_GT(crust / crusts, bare / bares + 0.1) << "mm";
}

TEST(SteelRusting, DegreeRunsFromZeroToOneEverywhere) {
  const SurfaceMaps fresh = steelAt(0), end = steelAt(1);
  for (const float d : fresh.degree.texels()) ASSERT_EQ(d, 0);
  for (const float d : end.degree.texels()) ASSERT_NEAR(d, 1, 1e-5);
}

}  // namespace
}  // namespace patina::devices::twin
