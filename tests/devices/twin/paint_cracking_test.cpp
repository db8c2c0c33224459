// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "devices/twin/specimen.h"
#include "tests/devices/twin/mean_of.h"

namespace patina::devices::twin {
namespace {

constexpr int kSide = 256;

const Specimen& paint() {
  static const auto once = makeSpecimen("paint_cracking", 5);
  return *once;
}
SurfaceMaps paintAt(double time) { return paint().surfaceAt(time, {kSide, kSide}); }

// Down to the wood, or nearly.
bool isGap(const SurfaceMaps& maps, int x, int y) { return maps.height.at(x, y) < 0.17f; }

double gapShare(const SurfaceMaps& maps) {
  double share = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) share += isGap(maps, x, y);
  return share / (kSide * kSide);
}

// Height of the reflected peak of a lamp: f0 / alpha^2.
double glossAt(double time) {
  const SurfaceMaps maps = paintAt(time);
  double sum = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      sum += maps.specular.at(x, y, 0) / std::pow(maps.roughness.at(x, y), 2);
  return sum / (kSide * kSide);
}

TEST(PaintCracking, IsRedAllOverUntilItCracks) {
  for (const double time : {0.0, 0.1, 0.19}) {
    const SurfaceMaps maps = paintAt(time);
    EXPECT_EQ(gapShare(maps), 0) << time;
    EXPECT_GT(meanOf(maps.diffuse, 0), 6 * meanOf(maps.diffuse, 1)) << time;
  }
}

TEST(PaintCracking, ItsGlossRisesWhileItLevelsAndFallsWhileItDries) {
  const double brushed = glossAt(0), levelled = glossAt(0.045), half = glossAt(0.12),
               dry = glossAt(0.25);
  EXPECT_GT(levelled, 5 * brushed);
  EXPECT_LT(half, 0.97 * levelled);
  EXPECT_LT(dry, 0.1 * levelled);
}

TEST(PaintCracking, AFrontPassesBetweenWetAndDry) {
  const SurfaceMaps maps = paintAt(0.11);
  double wet = 0, dry = 0;
  for (const float a : maps.roughness.texels()) {
    wet += a < 0.1f;
    dry += a > 0.3f;
  }
  EXPECT_GT(wet, 0.2 * kSide * kSide);
  EXPECT_GT(dry, 0.1 * kSide * kSide);
  EXPECT_GT(wet + dry, 0.8 * kSide * kSide) << "a narrow front";
}

TEST(PaintCracking, CracksOnlyGrow) {
  SurfaceMaps before = paintAt(0.2);
  double share = 0;
  for (const double time : {0.3, 0.4, 0.55, 0.7, 0.85, 1.0}) {
    SurfaceMaps now = paintAt(time);
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x)
        if (isGap(before, x, y)) {
          ASSERT_LT(now.height.at(x, y), 0.2f) << time;
        }
    EXPECT_GT(gapShare(now), share) << time;
    share = gapShare(now);
    before = std::move(now);
  }
  EXPECT_GT(share, 0.08);
  EXPECT_LT(share, 0.35) << "it stays a painted board";
}

TEST(PaintCracking, FirstCracksRunAlongTheGrainAndLaterOnesAcross) {
  const auto acrossOverAlong = [](const SurfaceMaps& now, const SurfaceMaps* before) {
    double across = 0, along = 0;  // edges of what is new
    const auto isNew = [&](int x, int y) {
      return now.height.at(x, y) < 0.25f && !(before && before->height.at(x, y) < 0.30f);
    };
    for (int y = 0; y + 1 < kSide; ++y)
      for (int x = 0; x + 1 < kSide; ++x) {
        along += isNew(x, y) != isNew(x + 1, y);
        across += isNew(x, y) != isNew(x, y + 1);
      }
    return across / along;
  };
  const SurfaceMaps first = paintAt(0.32);
  EXPECT_LT(acrossOverAlong(first, nullptr), 0.6);
  const SurfaceMaps middle = paintAt(0.45), later = paintAt(0.62);
  EXPECT_GT(acrossOverAlong(later, &middle), 1.5 * acrossOverAlong(first, nullptr));
}

TEST(PaintCracking, ACrackOpensWithinAFewHundredthsOfTheProcess) {
  const SurfaceMaps before = paintAt(0.30), after = paintAt(0.325);
  int opened = 0;
  for (std::size_t k = 0; k < before.height.texels().size(); ++k)
    opened += before.height.texels()[k] > 0.33f && after.height.texels()[k] < 0.1f;
  EXPECT_GT(opened, 20);
}

TEST(PaintCracking, EdgesOfPlatesCurlUp) {
  const auto heightAt = [](const SurfaceMaps& maps, const SurfaceMaps& end, bool near) {
    double sum = 0, n = 0;
    for (int y = 4; y + 4 < kSide; ++y)
      for (int x = 4; x + 4 < kSide; ++x) {
        int gaps = 0;
        for (int j = -4; j <= 4; ++j)
          for (int i = -4; i <= 4; ++i) gaps += isGap(end, x + i, y + j);
        if (end.height.at(x, y) < 0.3f || (gaps > 10) != near || (gaps > 0 && !near)) continue;
        sum += maps.height.at(x, y);
        ++n;
      }
    return sum / n;
  };
  const SurfaceMaps fresh = paintAt(0.19), end = paintAt(1);
  EXPECT_NEAR(heightAt(fresh, end, true), heightAt(fresh, end, false), 0.01) << "flat before";
  EXPECT_GT(heightAt(end, end, true), heightAt(end, end, false) + 0.05) << "mm";
}

TEST(PaintCracking, AYoungCrackIsDarkAndAWideOneShowsPaleWood) {
  const SurfaceMaps young = paintAt(0.26), end = paintAt(1);
  float darkest = 1;
  double pale = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      darkest = std::min(darkest, young.diffuse.at(x, y, 0));
      pale += end.diffuse.at(x, y, 0) > 0.35f && end.diffuse.at(x, y, 2) > 0.12f;
    }
  EXPECT_LT(darkest, 0.2f);
  EXPECT_GT(pale, 0.04 * kSide * kSide);
}

TEST(PaintCracking, DegreeRunsFromZeroToOneEverywhere) {
  const SurfaceMaps fresh = paintAt(0), end = paintAt(1);
  for (const float d : fresh.degree.texels()) ASSERT_EQ(d, 0);
  for (const float d : end.degree.texels()) ASSERT_NEAR(d, 1, 1e-5);
}

}  // namespace
}  // namespace patina::devices::twin
