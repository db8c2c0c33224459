// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::stbrdf::staf {
namespace {

std::vector<double> times() {
  std::vector<double> out;
  for (int t = 0; t < 25; ++t) out.push_back(t / 24.0);
  return out;
}

// A rise in the middle, as wet goes to dry.
Curve rise() {
  Texel as_is{.a = 1, .d = 0, .rate = 3, .offset = 1};
  std::vector<double> at, values;
  for (int i = 0; i < 60; ++i) {
    at.push_back(i / 59.0);
    values.push_back(std::tanh(3 * (3 * at.back() - 1.5)));
  }
  return fitCurve({as_is}, values, at);
}

TEST(Curve, SpeaksInMonomialsOfTheSameFunction) {
  const Curve curve = rise();
  const auto a = curve.monomials();
  for (double t = -1; t <= 2; t += 0.1) {
    double sum = 0;
    for (std::size_t k = a.size(); k-- > 0;) sum = sum * t + a[k];
    EXPECT_NEAR(sum, curve(t), 1e-9);
    EXPECT_NEAR(curve.slope(t), (curve(t + 1e-6) - curve(t - 1e-6)) / 2e-6, 1e-6);
  }
}

TEST(Grid, FindsRateAndOffsetOfATexelThatFollowsTheCurve) {
  const Curve curve = rise();
  const std::vector<double> when = times();
  const Grid grid(curve, when);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const double rate = 0.5 + 1.5 * uniform(hashSeed(seed, 1)),
                 offset = 0.8 * uniform(hashSeed(seed, 2)) + rate - 2 > -0.4 ? 0.3 : 0.1;
    std::vector<double> values;
    for (const double t : when) values.push_back(0.4 + 0.2 * curve(rate * t - offset));
    Texel texel;
    texel.error = INFINITY;
    grid.fit(values.data(), texel);
    EXPECT_LT(std::sqrt(texel.error / 25), 0.004) << seed;  // 1 % of its swing
  }
}

TEST(Grid, NeverMakesATexelWorse) {
  const Curve curve = rise();
  const std::vector<double> when = times();
  const Grid grid(curve, when);
  std::vector<double> values;
  for (std::size_t t = 0; t < when.size(); ++t) values.push_back(uniform(hashSeed(3, t)));
  Texel texel{.rate = 1.234, .offset = 0.2};
  solveLinear(curve, when, values.data(), texel);
  const double before = texel.error;
  grid.fit(values.data(), texel);
  EXPECT_LE(texel.error, before);
}

TEST(SolveLinear, GivesAConstantSeriesItsMean) {
  Texel texel;
  const std::vector<double> when = times(), values(when.size(), 0.7);
  solveLinear(rise(), when, values.data(), texel);
  EXPECT_NEAR(texel.a, 0, 1e-12);
  EXPECT_NEAR(texel.d, 0.7, 1e-12);
  EXPECT_NEAR(texel.error, 0, 1e-12);
}

}  // namespace
}  // namespace patina::stbrdf::staf
