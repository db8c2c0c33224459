// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "devices/twin/specimen.h"
#include "processing/brdf/ggx.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 224;

const Specimen& wood() {
  static const auto once = makeSpecimen("wood_drying", 5);
  return *once;
}
SurfaceMaps woodAt(double time) { return wood().surfaceAt(time, {kSide, kSide}); }

// Mean share of the way from wet to dry colour, over columns [x0, x1).
double dryness(const SurfaceMaps& now, int x0, int x1) {
  static const SurfaceMaps wet = woodAt(0), dry = woodAt(1);
  double sum = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = x0; x < x1; ++x)
      sum += (now.diffuse.at(x, y, 0) - wet.diffuse.at(x, y, 0)) /
             (dry.diffuse.at(x, y, 0) - wet.diffuse.at(x, y, 0));
  return sum / (kSide * (x1 - x0));
}

TEST(WoodDrying, WetWoodIsDarkerAndMoreSaturated) {
  const SurfaceMaps wet = woodAt(0), dry = woodAt(1);
  EXPECT_LT(meanOf(wet.diffuse, 0), 0.6 * meanOf(dry.diffuse, 0));
  EXPECT_GT(meanOf(wet.diffuse, 0) / meanOf(wet.diffuse, 2),
            1.5 * meanOf(dry.diffuse, 0) / meanOf(dry.diffuse, 2));
}

TEST(WoodDrying, WetWoodGleamsInItsMeasuredGloss) {
  const MeasuredReflectance* gloss = wood().measured();
  ASSERT_NE(gloss, nullptr);
  const brdf::Vec3 n;
  EXPECT_GT(brdf::abc(gloss->fresh, 0, n, n, n), 3 * brdf::abc(gloss->aged, 0, n, n, n));
  EXPECT_EQ(makeSpecimen("copper_patination", 1)->measured(), nullptr);
}

TEST(WoodDrying, TheWetFrontWithdrawsFromBothEndsToTheMiddle) {
  const SurfaceMaps early = woodAt(0.35);
  const double left = dryness(early, 0, 20), middle = dryness(early, 100, 124),
               right = dryness(early, kSide - 20, kSide);
  EXPECT_GT(left, 0.5);
  EXPECT_GT(right, 0.4);
  EXPECT_LT(middle, 0.15);
  double before = 0;
  for (const double time : {0.2, 0.35, 0.5, 0.65, 0.8, 1.0}) {
    const double now = dryness(woodAt(time), 0, kSide);
    EXPECT_GT(now, before + 0.03) << time;
    before = now;
  }
}

TEST(WoodDrying, TheFrontHasFingersAlongTheGrain) {
  // Wet and dry texels differ less often along x than along y.
  const SurfaceMaps maps = woodAt(0.45);
  const SurfaceMaps wet = woodAt(0), dry = woodAt(1);
  double along = 0, across = 0;
  const auto isDry = [&](int x, int y) {
    return 2 * maps.diffuse.at(x, y, 0) > wet.diffuse.at(x, y, 0) + dry.diffuse.at(x, y, 0);
  };
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      along += isDry(x, y) != isDry(x + 1, y);
      across += isDry(x, y) != isDry(x, y + 1);
    }
  EXPECT_GT(along, kSide) << "there is a front";
  EXPECT_GT(across, 2 * along);
}

TEST(WoodDrying, TheGlossGoesBeforeTheColour) {
  const SurfaceMaps maps = woodAt(0.3), dry = woodAt(1);
  double matt_but_dark = 0, pale_but_glossy = 0;
  const SurfaceMaps wet = woodAt(0);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const float paled = (maps.diffuse.at(x, y, 0) - wet.diffuse.at(x, y, 0)) /
                          (dry.diffuse.at(x, y, 0) - wet.diffuse.at(x, y, 0));
      matt_but_dark += maps.degree.at(x, y) > 0.44f && paled < 0.1f;
      pale_but_glossy += maps.degree.at(x, y) < 0.1f && paled > 0.3f;
    }
  EXPECT_GT(matt_but_dark / (kSide * kSide), 0.1);
  EXPECT_EQ(pale_but_glossy, 0);
}

TEST(WoodDrying, HasRingsAlongTheGrainAndAKnot) {
  const SurfaceMaps maps = woodAt(1);
  double along = 0, across = 0;
  double dark = 0;
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      along += std::abs(maps.diffuse.at(x + 1, y, 0) - maps.diffuse.at(x, y, 0));
      across += std::abs(maps.diffuse.at(x, y + 1, 0) - maps.diffuse.at(x, y, 0));
      dark += maps.diffuse.at(x, y, 0) < 0.22f;
    }
  EXPECT_GT(across, 2 * along);
  EXPECT_GT(dark / (kSide * kSide), 0.004) << "a knot of a few mm";
  EXPECT_LT(dark / (kSide * kSide), 0.05);
}

TEST(WoodDrying, TheSurfaceRoughensAndThePlankCups) {
  const SurfaceMaps wet = woodAt(0), dry = woodAt(1);
  const auto relief = [](const SurfaceMaps& maps) {  // how normals turn from fibre to fibre
    double sum = 0;
    for (int y = 0; y + 1 < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        sum += std::abs(maps.normal.at(x, y + 1, 1) - maps.normal.at(x, y, 1));
    return sum / (kSide * kSide);
  };
  EXPECT_GT(relief(dry), 8 * relief(wet));
  EXPECT_GT(meanOf(dry.roughness), 1.5 * meanOf(wet.roughness));
  const auto rowHeight = [](const SurfaceMaps& maps, int y) {
    double sum = 0;
    for (int x = 0; x < kSide; ++x) sum += maps.height.at(x, y) / kSide;
    return sum;
  };
  EXPECT_NEAR(rowHeight(wet, 0), rowHeight(wet, kSide / 2), 0.05);
  EXPECT_GT(rowHeight(dry, 0), rowHeight(dry, kSide / 2) + 0.6) << "mm";
  EXPECT_GT(rowHeight(dry, kSide - 1), rowHeight(dry, kSide / 2) + 0.6);
}

TEST(WoodDrying, ItsNormalsFollowItsHeightsAlongTheGrainToo) {
  const SurfaceMaps maps = wood().surfaceAt(0.5, {384, 384});
  double slope2 = 0, told2 = 0, both = 0;
  for (int y = 0; y < 384; ++y)
    for (int x = 1; x + 1 < 384; ++x) {
      const double slope = (maps.height.at(x + 1, y) - maps.height.at(x - 1, y)) /
                           (2 * wood().info().width_mm / 384);
      const double told = -maps.normal.at(x, y, 0) / maps.normal.at(x, y, 2);
      slope2 += slope * slope;
      told2 += told * told;
      both += slope * told;
    }
  EXPECT_GT(both / std::sqrt(slope2 * told2), 0.6) << "correlation";
}

// Diffuse and measured gloss together, whatever the view.
TEST(WoodDrying, NeverReflectsMoreThanItReceives) {
  const MeasuredReflectance& gloss = *wood().measured();
  const SurfaceMaps wet = woodAt(0), dry = woodAt(1);
  for (int c = 0; c < 3; ++c) {
    float wet_max = 0, dry_max = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        wet_max = std::max(wet_max, wet.diffuse.at(x, y, c));
        dry_max = std::max(dry_max, dry.diffuse.at(x, y, c));
      }
    for (const double n_v : {1.0, 0.7, 0.4, 0.2, 0.1, 0.05}) {
      EXPECT_LE(wet_max + brdf::abcDirectionalAlbedo(gloss.fresh, c, n_v), 1) << n_v;
      EXPECT_LE(dry_max + brdf::abcDirectionalAlbedo(gloss.aged, c, n_v), 1) << n_v;
    }
  }
}

TEST(WoodDrying, ItsRowsHoldTheNearestGgxOfItsGloss) {
  const brdf::GgxEquivalent fresh = brdf::nearestGgx(wood().measured()->fresh),
                            aged = brdf::nearestGgx(wood().measured()->aged);
  const SurfaceMaps wet = woodAt(0), half = woodAt(0.5), dry = woodAt(1);
  EXPECT_FLOAT_EQ(wet.roughness.at(7, 9), fresh.alpha);
  EXPECT_FLOAT_EQ(wet.specular.at(7, 9, 1), fresh.f0[1]);
  EXPECT_NEAR(dry.roughness.at(7, 9), aged.alpha, 1e-6);
  EXPECT_NEAR(dry.specular.at(7, 9, 2), aged.f0[2], 1e-6);
  const float degree = half.degree.at(7, 9);
  EXPECT_NEAR(half.roughness.at(7, 9), fresh.alpha + (aged.alpha - fresh.alpha) * degree, 1e-6);
}

TEST(WoodDrying, DegreeRunsFromZeroToOneEverywhere) {
  const SurfaceMaps fresh = woodAt(0), end = woodAt(1);
  for (const float d : fresh.degree.texels()) ASSERT_EQ(d, 0);
  for (const float d : end.degree.texels()) ASSERT_NEAR(d, 1, 1e-5);
}

}  // namespace
}  // namespace patina::devices::twin
