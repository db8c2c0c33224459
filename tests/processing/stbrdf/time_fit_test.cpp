// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/time_fit.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::stbrdf {
namespace {

std::vector<double> unevenTimes(int n) {
  std::vector<double> times;
  for (int i = 0; i < n; ++i) times.push_back(std::pow((i + 0.5 * uniform(hashSeed(3, i))) / n, 2));
  return times;
}

std::string refusal(std::vector<double> times, std::vector<double> weights, int degree) {
  try {
    const TimeFit fit(times, weights, degree);
  } catch (const ProcessingError& e) {
    return e.exit() == Exit::kUsage ? e.what() : "another exit code";
  }
  return "taken";
}

TEST(TimeFit, GivesPolynomialsOfItsDegreeBack) {
  for (int degree = 0; degree <= kDegreeMax; ++degree) {
    const TimeFit fit(unevenTimes(30), {}, degree);
    for (int j = 0; j <= degree; ++j)
      for (int k = 0; k <= degree; ++k) {
        double sum = 0;
        for (int t = 0; t < 30; ++t) {
          double values[kTermsMax];
          basisValues(Basis::kLegendre, degree, fit.times()[t], values);
          sum += fit.projection()[k * 30 + t] * values[j];
        }
        EXPECT_NEAR(sum, j == k ? 1 : 0, 1e-9) << degree;
      }
  }
}

// At the optimum the weighted residual is orthogonal to every basis function.
TEST(TimeFit, LeavesAResidualOrthogonalToAllPolynomials) {
  constexpr int kSteps = 25, kDegree = 7;
  std::vector<double> weights, samples;
  for (int t = 0; t < kSteps; ++t) {
    weights.push_back(0.2 + uniform(hashSeed(1, t)));
    samples.push_back(uniform(hashSeed(2, t)));
  }
  const TimeFit fit(unevenTimes(kSteps), weights, kDegree);
  double moments[kTermsMax] = {};
  for (int t = 0; t < kSteps; ++t) {
    double values[kTermsMax], p = 0;
    basisValues(Basis::kLegendre, kDegree, fit.times()[t], values);
    for (int k = 0; k <= kDegree; ++k) {
      double c = 0;
      for (int u = 0; u < kSteps; ++u) c += fit.projection()[k * kSteps + u] * samples[u];
      p += c * values[k];
    }
    for (int k = 0; k <= kDegree; ++k) moments[k] += weights[t] * (samples[t] - p) * values[k];
  }
  for (int k = 0; k <= kDegree; ++k) EXPECT_NEAR(moments[k], 0, 1e-10);
}

TEST(TimeFit, RefusesWhatItCannotFitAndSaysWhy) {
  using testing::HasSubstr;
  const std::vector<double> three{0, 0.5, 1};
  EXPECT_EQ(refusal(three, {}, 2), "taken");
  EXPECT_THAT(refusal(three, {}, 3), HasSubstr("needs 4 different times; there are 3"));
  EXPECT_THAT(refusal({0.5, 0.5, 0.5, 1}, {}, 2), HasSubstr("there are 2"));
  EXPECT_THAT(refusal(three, {}, 13), HasSubstr("between 0 and 12"));
  EXPECT_THAT(refusal({0, 0.5, 1.5}, {}, 1), HasSubstr("times lie in [0,1]"));
  EXPECT_THAT(refusal({0, NAN, 1}, {}, 1), HasSubstr("times lie in [0,1]"));
  EXPECT_THAT(refusal(three, {1, 1}, 1), HasSubstr("3 times and 2 weights"));
  EXPECT_THAT(refusal(three, {1, 0, 1}, 1), HasSubstr("not above 0"));
  EXPECT_THAT(refusal({0, 1e-9, 2e-9, 3e-9, 1}, {}, 4), HasSubstr("too close together"));
}

}  // namespace
}  // namespace patina::stbrdf
