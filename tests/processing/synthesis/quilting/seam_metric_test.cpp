// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_metric.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "processing/image/random.h"

namespace patina::quilting {
namespace {

// Two frames, shown by one feature each: strokes along rows, and grains.
TtfFeatures strokesThenGrains(float along_strokes) {
  TtfFeatures f{Image<float>(60, 50, 2), {}, {}, {}, 0};
  for (int y = 0; y < 50; ++y)
    for (int x = 0; x < 60; ++x) {
      f.features.at(x, y, 0) = static_cast<float>(gaussian(hashSeed(1, y))) +
                               along_strokes * static_cast<float>(gaussian(hashSeed(2, x, y)));
      f.features.at(x, y, 1) = static_cast<float>(gaussian(hashSeed(3, x, y)));
    }
  f.basis = {1, 0, 0, 1};
  f.mean = {0, 0};
  f.weight = {4, 1};
  return f;
}

double lengthOf(const SeamMetric& metric, int direction, std::array<float, 2> c) {
  std::array<float, 2> out{};
  metric.apply(direction, c.data(), out.data());
  return std::hypot(out[0], out[1]);
}

// Gradients are of 2 sigma^2 in the mean square; each frame counts a half.
TEST(SeamMetric, MeasuresEachFrameByItsOwnGradientInThatDirection) {
  const SeamMetric metric = seamMetric(strokesThenGrains(0.5f));
  EXPECT_NEAR(lengthOf(metric, 0, {0, 1}), std::sqrt(0.5 / 2), 0.03);
  EXPECT_NEAR(lengthOf(metric, 1, {0, 1}), std::sqrt(0.5 / 2), 0.03);
  EXPECT_NEAR(lengthOf(metric, 0, {1, 0}), std::sqrt(0.5 / (2 * 0.25)), 0.1);
  EXPECT_NEAR(lengthOf(metric, 1, {1, 0}), std::sqrt(0.5 / (2 * 1.25)), 0.1);
}

TEST(SeamMetric, WantsRaggedSeamsAcrossStrokesOnly) {
  const SeamMetric strokes = seamMetric(strokesThenGrains(0.2f)),
                   none = seamMetric(strokesThenGrains(20));
  EXPECT_NEAR(strokes.ragged[0], 0.5 * std::log(std::sqrt(1.04) / 0.2), 0.2);
  EXPECT_LT(strokes.ragged[1], 0.03);
  EXPECT_LT(none.ragged[0], 0.03);
}

TEST(SeamMetric, StaysFiniteInFramesWithoutGradient) {
  TtfFeatures f = strokesThenGrains(0.5f);
  f.basis = {0, 0, 0, 1};
  const SeamMetric metric = seamMetric(f);
  EXPECT_LT(lengthOf(metric, 0, {1, 0}), 1e-3);
  EXPECT_NEAR(lengthOf(metric, 0, {0, 1}), std::sqrt(0.5 / 2), 0.03);
  f.features = Image<float>(60, 50, 2);
  EXPECT_TRUE(std::isfinite(lengthOf(seamMetric(f), 1, {1, 1})));
}

}  // namespace
}  // namespace patina::quilting
