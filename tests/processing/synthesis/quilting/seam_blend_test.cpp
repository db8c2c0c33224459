// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_blend.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {
namespace {

// Left half from x = 0 on, right half from `second` on: one straight seam at x = 30.
Quilt halves(int second) {
  Quilt q{Image<std::int32_t>(60, 20, 2), Image<std::int32_t>(60, 20, 1)};
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 60; ++x) {
      q.source_xy.at(x, y, 0) = x < 30 ? x : second + x - 30;
      q.source_xy.at(x, y, 1) = y;
    }
  return q;
}

// A step of 1 at x = 70, no other change.
Image<float> step() {
  Image<float> f(140, 20, 2);
  for (int y = 0; y < 20; ++y)
    for (int x = 70; x < 140; ++x) f.at(x, y, 0) = f.at(x, y, 1) = 1;
  return f;
}

Image<float> corrected(const Image<float>& features, const Quilt& quilt, double blend_px,
                       bool wraps = false) {
  Progress progress;
  Image<float> c = seamCorrection(features.view(), quilt, blend_px, wraps, progress);
  const Image<float> copies = applyQuilt(features.view(), quilt);
  for (std::size_t i = 0; i < c.texels().size(); ++i) c.texels()[i] += copies.texels()[i];
  return c;
}

TEST(SeamCorrection, SpreadsAStepOverItsReachAndLeavesTheRestAlone) {
  const Image<float> result = corrected(step(), halves(90), 5);
  for (int y = 0; y < 20; ++y) {
    float steepest = 0;
    for (int x = 1; x < 60; ++x)
      steepest = std::max(steepest, std::abs(result.at(x, y, 1) - result.at(x - 1, y, 1)));
    EXPECT_LT(steepest, 0.15);  // of a step of 1
    EXPECT_NEAR(result.at(29, y, 0) + result.at(30, y, 0), 1, 1e-3);
    EXPECT_EQ(result.at(13, y, 0), 0);
    EXPECT_EQ(result.at(47, y, 0), 1);
  }
}

TEST(SeamCorrection, IsNothingWhereBothSidesGoOnAlike) {
  Image<float> repeats = periodicTexture({140, 20}, 30);
  Progress progress;
  const Image<float> c = seamCorrection(repeats.view(), halves(90), 5, false, progress);
  EXPECT_EQ(*std::max_element(c.texels().begin(), c.texels().end()), 0);
  EXPECT_EQ(*std::min_element(c.texels().begin(), c.texels().end()), 0);
}

TEST(SeamCorrection, KeepsTheGradientsThatBothSourcesHave) {
  Image<float> ramp(140, 20, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 140; ++x) ramp.at(x, y) = 0.1f * x;
  const Image<float> result = corrected(ramp, halves(90), 8);
  EXPECT_NEAR(result.at(30, 10) - result.at(29, 10), 0.1, 0.6);  // the copies' step is 6.1
}

// A corner's slope is 0.1 before the seam and 0.3 behind it.
TEST(SeamCorrection, GoesOnAsOneSideAsTheMeanOrBetweenByTheShareAskedFor) {
  Image<float> bent(140, 20, 1);
  for (int y = 0; y < 20; ++y)
    for (int x = 1; x < 140; ++x) bent.at(x, y) = bent.at(x - 1, y) + (x < 60 ? 0.1f : 0.3f);
  const Quilt quilt = halves(90);
  const Image<float> copies = applyQuilt(bent.view(), quilt);
  const auto slope = [&](double one_sided) {
    Progress progress;
    const Image<float> c =
        seamCorrection(bent.view(), quilt, 200, false, progress, nullptr, one_sided);
    return copies.at(30, 10) + c.at(30, 10) - copies.at(29, 10) - c.at(29, 10);
  };
  EXPECT_NEAR(slope(1), 0.1, 0.05);
  EXPECT_NEAR(slope(0), 0.2, 0.05);
  EXPECT_NEAR(slope(0.5), (slope(0) + slope(1)) / 2, 0.01);
}

TEST(SeamCorrection, CrossesTheEdgeWhereTheResultWraps) {
  const Image<float> result = corrected(step(), halves(90), 5, true);
  EXPECT_LT(std::abs(result.at(0, 10, 0) - result.at(59, 10, 0)), 0.15);
  EXPECT_GT(std::abs(corrected(step(), halves(90), 5).at(0, 10, 0) -
                     corrected(step(), halves(90), 5).at(59, 10, 0)),
            0.9);
}

TEST(SeamCorrection, IsTheSameForAnyNumberOfThreads) {
  const Image<float> f = waveTexture({140, 20}, 3);
  std::vector<float> first;
  for (int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const Image<float> c = corrected(f, halves(77), 4, true);
    if (first.empty()) first = c.texels();
    EXPECT_EQ(c.texels(), first);
  }
}

TEST(SeamBlend, MovesSamplesAsDisplayedAndKeepsTheRestBitForBit) {
  Image<float> correction(2, 1, 1);
  correction.at(1, 0) = 0.5f;
  TtfFeatures f;
  f.basis = {0.0f, 0.4f};  // frame 0 does not take part
  f.weight = {1, 2};
  const SeamBlend blend(correction, f, 1.0);
  Image<std::uint16_t> frame(2, 1, 1, 14027);  // 0.5 as displayed
  blend.apply(0, frame.view());
  EXPECT_EQ(frame.at(0, 0), 14027);
  EXPECT_NEAR(frame.at(1, 0), 14027, 1);
  blend.apply(1, frame.view());
  EXPECT_EQ(frame.at(0, 0), 14027);
  EXPECT_NEAR(frame.at(1, 0) / 65535.0, 0.3185, 0.0002);  // 0.5 + 0.5 * 0.4 / 2 = 0.6
  Image<float> linear(2, 1, 1, 0.214041f);
  blend.apply(1, linear.view());
  EXPECT_EQ(linear.at(0, 0), 0.214041f);
  EXPECT_NEAR(linear.at(1, 0), 0.3185, 0.0002);
}

}  // namespace
}  // namespace patina::quilting
