// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/constraints.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::texture_optimization {
namespace {

TEST(Constraints, KeepTheSampleWhereTheMaskIsWhite) {
  Image<float> mask(6, 5, 1);
  mask.at(2, 1) = 1;
  mask.at(3, 1) = 0.2f;
  const std::vector<std::int32_t> kept = keptFrom(mask.view(), {20, 10}, 7, 3);
  EXPECT_EQ(kept[8], 4 * 20 + 9);
  EXPECT_EQ(kept[9], -1);
  EXPECT_THROW(keptFrom(mask.view(), {20, 10}, 18, 3), ProcessingError);
  EXPECT_THROW(keptFrom(mask.view(), {20, 10}, -3, 3), ProcessingError);
}

TEST(Constraints, PutGuidesBehindOneAnotherTimesTheRootOfTheirWeight) {
  Constraints constraints;
  addGuide(constraints, Image<float>(4, 3, 1, 0.5f).view(), Image<float>(8, 6, 1, 0.25f).view(), 4);
  addGuide(constraints, Image<float>(4, 3, 2, 1.0f).view(), Image<float>(8, 6, 2, 2.0f).view(), 9);
  ASSERT_EQ(constraints.sample_guide.channels(), 3);
  EXPECT_FLOAT_EQ(constraints.sample_guide.at(3, 2, 0), 1);
  EXPECT_FLOAT_EQ(constraints.sample_guide.at(3, 2, 2), 3);
  EXPECT_FLOAT_EQ(constraints.result_guide.at(7, 5, 0), 0.5f);
  EXPECT_FLOAT_EQ(constraints.result_guide.at(7, 5, 1), 6);
}

TEST(Constraints, RefuseGuidesThatCannotBe) {
  Constraints constraints;
  const Image<float> small(4, 3, 1), large(8, 6, 1);
  const auto exitOf = [&](const Image<float>& sample, const Image<float>& result, double weight) {
    try {
      addGuide(constraints, sample.view(), result.view(), weight);
    } catch (const ProcessingError& e) {
      return e.exit();
    }
    return Exit::kOk;
  };
  EXPECT_EQ(exitOf(small, large, 0), Exit::kUsage);
  EXPECT_EQ(exitOf(small, large, NAN), Exit::kUsage);
  EXPECT_EQ(exitOf(small, Image<float>(8, 6, 2), 1), Exit::kUsage);
  EXPECT_EQ(exitOf(Image<float>(4, 3, 25), Image<float>(8, 6, 25), 1), Exit::kUsage);
  EXPECT_EQ(exitOf(Image<float>(4, 3, 1, NAN), large, 1), Exit::kBadData);
  EXPECT_EQ(exitOf(small, large, 1), Exit::kOk);
  EXPECT_EQ(exitOf(large, large, 1), Exit::kUsage);
  EXPECT_EQ(constraints.sample_guide.channels(), 1);
}

TEST(Constraints, GradientsRunFromOneSideToTheOtherOfBoth) {
  Constraints constraints;
  addGradientGuides(constraints, {10, 20}, {40, 50}, 1);
  EXPECT_NEAR(constraints.sample_guide.at(9, 0, 0), 0.95f, 1e-6);
  EXPECT_NEAR(constraints.result_guide.at(39, 0, 0), 0.9875f, 1e-6);
  EXPECT_NEAR(constraints.result_guide.at(0, 25, 1), 0.51f, 1e-6);
}

}  // namespace
}  // namespace patina::texture_optimization
