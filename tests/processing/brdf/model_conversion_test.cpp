// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/model_conversion.h"

#include <gtest/gtest.h>

namespace patina::brdf {
namespace {

constexpr Model kAll[] = {Model::kGgx, Model::kWard, Model::kTorranceSparrow};

TEST(ModelConversion, ToTheSameModelGivesTheSameParametersAndNoError) {
  for (const Model model : kAll)
    for (const double roughness : {0.05, 0.2, 0.6}) {
      const Conversion same = convert({0.3, roughness}, model, model);
      EXPECT_NEAR(same.part.specular, 0.3, 1e-3) << nameOf(model) << roughness;
      EXPECT_NEAR(same.part.roughness, roughness, 2e-3 * roughness) << nameOf(model);
      EXPECT_LT(same.relative_error, 1e-3);
    }
}

TEST(ModelConversion, NarrowGaussiansOfSineAndTangentAreAlike) {
  const Conversion ward = convert({0.2, 0.08}, Model::kTorranceSparrow, Model::kWard);
  EXPECT_NEAR(ward.part.roughness, 0.08, 0.002);
  EXPECT_NEAR(ward.part.specular, 0.2, 0.01);
  EXPECT_LT(ward.relative_error, 0.03);
}

TEST(ModelConversion, BetweenGgxAndAGaussianAnErrorStaysAndIsTold) {
  const Conversion there = convert({0.04, 0.3}, Model::kGgx, Model::kWard);
  EXPECT_GT(there.relative_error, 0.03);
  EXPECT_LT(there.relative_error, 0.4);
  const Conversion back = convert(there.part, Model::kWard, Model::kGgx);
  EXPECT_NEAR(back.part.roughness, 0.3, 0.06);
}

TEST(ModelConversion, AWiderLobeStaysWider) {
  for (const Model from : kAll)
    for (const Model to : kAll) {
      double before = 0;
      for (const double roughness : {0.05, 0.1, 0.2, 0.4}) {
        const double now = convert({0.5, roughness}, from, to).part.roughness;
        EXPECT_GT(now, before) << nameOf(from) << nameOf(to) << roughness;
        before = now;
      }
    }
}

TEST(ModelConversion, PerceptualRoughnessIsTheRootOfAlpha) {
  EXPECT_DOUBLE_EQ(alphaFrom(0.5, RoughnessKind::kPerceptual), 0.25);
  EXPECT_DOUBLE_EQ(roughnessFrom(0.25, RoughnessKind::kPerceptual), 0.5);
  EXPECT_DOUBLE_EQ(alphaFrom(0.5, RoughnessKind::kAlpha), 0.5);
}

}  // namespace
}  // namespace patina::brdf
