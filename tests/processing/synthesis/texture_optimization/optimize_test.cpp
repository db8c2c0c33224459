// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/optimize.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "tests/processing/synthesis/texture_optimization/samples.h"

namespace patina::texture_optimization {
namespace {

Image<float> features() { return blobs(48).maps[0].coefficients[0]; }

OptimizeOptions shortly(SizePx size) {
  OptimizeOptions options;
  options.size = size;
  options.rounds = 4;
  return options;
}

TEST(Optimize, ShowsPatchesOfTheSourceThatFitTogether) {
  Progress progress;
  const Image<float> sample = features();
  const OptimizedField field = optimize(sample.view(), shortly({100, 80}), progress);
  EXPECT_EQ(field.levels, 3);
  ASSERT_EQ(field.centres.size(), 8000u);
  for (const std::int32_t centre : field.centres) {
    ASSERT_TRUE(centre % 48 >= 2 && centre % 48 < 46);
    ASSERT_TRUE(centre / 48 >= 2 && centre / 48 < 46);
  }
  // A patch picked blindly differs by 25 * 3 * 2 * 0.058 on average.
  EXPECT_LT(field.energy.patch, 0.5);
  EXPECT_LT(field.energy.occupancy, 1.6);
}

TEST(Optimize, IsTheSameForAnyNumberOfThreadsAndAnotherForAnotherSeed) {
  Progress progress;
  const Image<float> sample = features();
  std::vector<std::vector<std::int32_t>> centres;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    centres.push_back(optimize(sample.view(), shortly({90, 70}), progress).centres);
  }
  EXPECT_EQ(centres[0], centres[1]);
  EXPECT_EQ(centres[0], centres[2]);
  OptimizeOptions other = shortly({90, 70});
  other.field.seed = 2;
  EXPECT_NE(optimize(sample.view(), other, progress).centres, centres[0]);
}

TEST(Voted, AveragesWhatThePatchesOverATexelShow) {
  Image<float> source(9, 9, 1);
  for (int y = 0; y < 9; ++y)
    for (int x = 0; x < 9; ++x) source.at(x, y) = static_cast<float>(x + 10 * y);
  OptimizedField field;
  field.size = {5, 5};
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x) field.centres.push_back((y + 2) * 9 + x + 2);
  const Image<float> whole = voted(source.view(), field, 5);
  EXPECT_FLOAT_EQ(whole.at(0, 0), 22);
  EXPECT_FLOAT_EQ(whole.at(4, 2), 46);
  field.centres[12] = 2 * 9 + 2;  // the middle patch shows what lies 2 up and 2 left
  EXPECT_FLOAT_EQ(voted(source.view(), field, 5).at(2, 2), 44 - 22.0f / 25);
}

TEST(Optimize, RefusesWhatCannotBe) {
  Progress progress;
  const auto exitOf = [&](const Image<float>& sample, const OptimizeOptions& options) {
    try {
      optimize(sample.view(), options, progress);
    } catch (const ProcessingError& e) {
      return e.exit();
    }
    return Exit::kOk;
  };
  EXPECT_EQ(exitOf(Image<float>(4, 40, 1), shortly({50, 50})), Exit::kUsage);
  EXPECT_EQ(exitOf(features(), shortly({50, 3})), Exit::kUsage);
  OptimizeOptions odd = shortly({50, 50});
  odd.components = 9;
  EXPECT_EQ(exitOf(features(), odd), Exit::kUsage);
  Image<float> broken = features();
  broken.at(3, 3) = NAN;
  EXPECT_EQ(exitOf(broken, shortly({50, 50})), Exit::kBadData);
  EXPECT_EQ(exitOf(Image<float>(20, 20, 2, 0.5f), shortly({50, 50})), Exit::kOk);
}

}  // namespace
}  // namespace patina::texture_optimization
