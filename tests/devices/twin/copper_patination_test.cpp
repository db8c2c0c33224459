// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "devices/twin/specimen.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 160;

// Share of texels that are green, not metal nor brown.
double greenShare(const SurfaceMaps& maps) {
  double share = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      share += maps.diffuse.at(x, y, 1) > 1.5f * maps.diffuse.at(x, y, 0) &&
               maps.diffuse.at(x, y, 1) > 0.1f;
  return share / (kSide * kSide);
}

TEST(CopperPatination, BeginsAsBrightBrushedMetal) {
  const SurfaceMaps maps = makeSpecimen("copper_patination", 5)->surfaceAt(0, {kSide, kSide});
  EXPECT_GT(meanOf(maps.specular, 0), 0.8);
  EXPECT_GT(meanOf(maps.specular, 0), 1.5 * meanOf(maps.specular, 2)) << "copper is red";
  EXPECT_LT(meanOf(maps.diffuse), 0.05);
  EXPECT_EQ(meanOf(maps.degree), 0);
}

TEST(CopperPatination, TheLiquidIsSmoothAndDriesFromPatches) {
  const auto copper = makeSpecimen("copper_patination", 5);
  const SurfaceMaps dry = copper->surfaceAt(0, {kSide, kSide}),
                    wet = copper->surfaceAt(0.09, {kSide, kSide}),
                    partly = copper->surfaceAt(0.28, {kSide, kSide});
  EXPECT_LT(meanOf(wet.roughness), 0.5 * meanOf(dry.roughness));
  double still_wet = 0;
  for (const float r : partly.roughness.texels()) still_wet += r < 0.25f;
  still_wet /= kSide * kSide;
  EXPECT_GT(still_wet, 0.05);
  EXPECT_LT(still_wet, 0.9);
}

TEST(CopperPatination, GreenSpreadsAfterBrown) {
  const auto copper = makeSpecimen("copper_patination", 5);
  EXPECT_EQ(greenShare(copper->surfaceAt(0.1, {kSide, kSide})), 0);
  double before = 0;
  for (const double time : {0.45, 0.6, 0.75, 0.9, 1.0}) {
    const double now = greenShare(copper->surfaceAt(time, {kSide, kSide}));
    EXPECT_GT(now, before) << time;
    before = now;
  }
  EXPECT_GT(before, 0.45);
  EXPECT_LT(before, 0.97) << "some brown stays";
}

TEST(CopperPatination, RoughensAndItsDegreeNearsOne) {
  const SurfaceMaps end = makeSpecimen("copper_patination", 5)->surfaceAt(1, {kSide, kSide});
  EXPECT_GT(meanOf(end.roughness), 0.65);
  EXPECT_GT(meanOf(end.degree), 0.7);
  EXPECT_GT(*std::max_element(end.degree.texels().begin(), end.degree.texels().end()), 0.99f);
}

}  // namespace
}  // namespace patina::devices::twin
