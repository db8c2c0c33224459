// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/copies.h"

#include <gtest/gtest.h>

#include "tests/processing/synthesis/texture_optimization/samples.h"

namespace patina::texture_optimization {
namespace {

constexpr int kSource = 64, kResult = 128;

std::size_t indexOf(int x, int y) {
  return static_cast<std::size_t>(y) * kResult + static_cast<std::size_t>(x);
}

// Two whole copies of the sample in the upper half, the second `shift` texels to the right of the
// first; what neither covers shows one place again and again, never a whole cell of it.
OptimizedField twoCopies(int shift) {
  OptimizedField field{.size = {kResult, kResult},
                       .source = {kSource, kSource},
                       .centres = {},
                       .kept = {},
                       .gain = {},
                       .energy = {},
                       .landmarks = {}};
  for (int y = 0; y < kResult; ++y)
    for (int x = 0; x < kResult; ++x) {
      const int sx = x < shift ? x : x - shift;
      const bool covered = y < kSource && sx < kSource;
      field.centres.push_back(covered ? y * kSource + sx : 2 * kSource + 2);
    }
  return field;
}

TEST(CopiesApart, IsTheDistanceOfTwoCopiesOverTheSamplesSide) {
  const CopiesApart apart = copiesApart(twoCopies(64));
  EXPECT_EQ(apart.shown_again, 1);
  EXPECT_DOUBLE_EQ(apart.least, 1);
  EXPECT_DOUBLE_EQ(apart.median, 1);
  const CopiesApart nearer = copiesApart(twoCopies(48));
  EXPECT_DOUBLE_EQ(nearer.median, 0.75);
  EXPECT_NEAR(nearer.shown_again, 0.75, 1e-9);
}

TEST(CopiesApart, IsNothingWhereNothingIsShownTwice) {
  OptimizedField field = twoCopies(64);
  for (int y = 0; y < kResult; ++y)
    for (int x = 64; x < kResult; ++x) field.centres[indexOf(x, y)] = 2 * kSource + 2;
  const CopiesApart apart = copiesApart(field);
  EXPECT_EQ(apart.shown_again, 0);
  EXPECT_EQ(apart.least, 0);
}

TEST(CopiesApart, GoesAroundWhereTheResultWraps) {
  OptimizedField field = twoCopies(64);
  field.size.width = 128;
  for (const bool wraps : {false, true}) {
    field.wraps = wraps;
    // The second copy moved to the right end: 80 texels off, 48 the other way around.
    for (int y = 0; y < kSource; ++y)
      for (int x = 64; x < kResult; ++x)
        field.centres[indexOf(x, y)] = x < 80 ? 2 * kSource + 2 : y * kSource + x - 80;
    EXPECT_DOUBLE_EQ(copiesApart(field).median, wraps ? 0.75 : 1.25);
  }
}

// A landmark of 8x8 texels at 24,24 of the sample; the copies of the sample show it.
OptimizedField twoLandmarks(int shift) {
  OptimizedField field = twoCopies(shift);
  field.landmarks = {.size = {kSource, kSource}, .count = 1, .of = {}};
  for (int y = 0; y < kSource; ++y)
    for (int x = 0; x < kSource; ++x)
      field.landmarks.of.push_back(x / 8 == 3 && y / 8 == 3 ? 0 : -1);
  return field;
}

TEST(LandmarksApart, IsTheDistanceOfTwoCopiesWholeOrCut) {
  EXPECT_DOUBLE_EQ(landmarksApart(twoLandmarks(48)), 0.75);
  EXPECT_DOUBLE_EQ(landmarksApart(twoLandmarks(0)), 0);
  // Half of it a third time, and a sliver that is not known again.
  OptimizedField field = twoLandmarks(64);
  const auto show = [&](int left, int width, int height) {
    for (int y = 24; y < 24 + height; ++y)
      for (int x = 0; x < width; ++x) field.centres[indexOf(left + x, y)] = y * kSource + 28 + x;
  };
  show(44, 1, 7);
  show(46, 4, 8);
  EXPECT_DOUBLE_EQ(landmarksApart(field), 20.0 / kSource);
}

TEST(LandmarksApart, TakesWhatShowsOnePlaceForOneCopy) {
  OptimizedField field = twoLandmarks(64);
  for (int y = 24; y < 32; ++y) field.centres[indexOf(28, y)] = 2 * kSource + 2;  // cut in two
  EXPECT_NEAR(landmarksApart(field), 1 - 2.5 / kSource, 1e-9);
}

TEST(LandmarksApart, GoesAroundWhereTheResultWraps) {
  OptimizedField field = twoLandmarks(64);
  for (const bool wraps : {false, true}) {
    field.wraps = wraps;
    for (int y = 0; y < kSource; ++y)
      for (int x = 64; x < kResult; ++x)
        field.centres[indexOf(x, y)] = x < 80 ? 2 * kSource + 2 : y * kSource + x - 80;
    EXPECT_DOUBLE_EQ(landmarksApart(field), wraps ? 0.75 : 1.25);
  }
}

// A sample with one landmark amid a pattern that goes on everywhere: the optimiser may show any
// place anywhere, so only what keeps copies apart can.
TEST(CopiesApart, AreFartherApartThanChanceWouldHaveIt) {
  Progress progress;
  const Image<float> sample = blobs(kSource).maps[0].coefficients[0];
  OptimizeOptions options;
  options.size = {kResult, kResult};
  const CopiesApart apart = copiesApart(optimize(sample.view(), options, {}, progress));
  EXPECT_GT(apart.median, 0.55);
}

}  // namespace
}  // namespace patina::texture_optimization
