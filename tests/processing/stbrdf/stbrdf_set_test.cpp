// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/stbrdf_set.h"

#include <gtest/gtest.h>

namespace patina::stbrdf {
namespace {

TimeMap parabola() {
  TimeMap map{.name = "Diffuse", .coefficients = {}};
  for (const float a : {0.25f, 2.0f, -1.5f}) map.coefficients.emplace_back(2, 2, 3, a);
  return map;
}

TEST(Evaluate, FollowsThePolynomialAndClampsOnlyWhenAsked) {
  const TimeMap map = parabola();
  const auto at = [&](double t, Clamp clamp) {
    return evaluate(map, Basis::kMonomial, t, clamp).at(1, 1, 2);
  };
  EXPECT_EQ(at(0, Clamp::kNone), 0.25f);
  EXPECT_FLOAT_EQ(at(0.5, Clamp::kNone), 0.875f);
  EXPECT_FLOAT_EQ(at(0.6, Clamp::kNone), 0.91f);
  TimeMap bright = parabola();
  bright.high = 0.9f;
  bright.low = 0.3f;
  EXPECT_EQ(evaluate(bright, Basis::kMonomial, 0.6, Clamp::kToRange).at(0, 0), 0.9f);
  EXPECT_EQ(evaluate(bright, Basis::kMonomial, 0, Clamp::kToRange).at(0, 0), 0.3f);
}

TEST(Convert, ChangesTheBasisAndNotTheValues) {
  StbrdfSet set{.degree = 2, .maps = {parabola()}, .facts = {}};
  convert(set, Basis::kLegendre);
  EXPECT_EQ(set.basis, Basis::kLegendre);
  EXPECT_NE(set.maps[0].coefficients[0].at(0, 0), 0.25f);
  EXPECT_NEAR(evaluate(set.maps[0], set.basis, 0.6, Clamp::kNone).at(0, 0), 0.91, 1e-6);
  convert(set, Basis::kMonomial);
  EXPECT_NEAR(set.maps[0].coefficients[2].at(1, 0, 1), -1.5, 1e-6);
}

}  // namespace
}  // namespace patina::stbrdf
