// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/polynomial_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/stbrdf/stbrdf_file.h"
#include "tests/support/places.h"

namespace patina::stbrdf {
namespace {

TimeSamples sampled(const TimeMap& map, Basis basis, int steps) {
  TimeSamples out{map.name, {}, {}};
  for (int t = 0; t < steps; ++t) {
    out.times.push_back(t / (steps - 1.0));
    out.maps.push_back(evaluate(map, basis, out.times.back(), Clamp::kNone));
  }
  return out;
}

TimeSamples ramp(float from, float to) {
  TimeSamples out{"Roughness", {0, 0.25, 1}, {}};
  for (const double t : out.times)
    out.maps.emplace_back(3, 2, 1, from + (to - from) * static_cast<float>(t));
  return out;
}

TEST(FitMap, GivesThePublishedCoefficientsBack) {
  PATINA_TEST_DATA_OR_SKIP(folder, "snowyground_stbrdf");
  Progress progress;
  const StbrdfSet set = readStbrdfSet(folder, progress);
  for (const TimeMap& map : set.maps) {
    const FittedMap fitted =
        fitMap(sampled(map, set.basis, 50), {.degree = 3, .weights = {}}, progress);
    double worst = 0;
    for (std::size_t k = 0; k < 4; ++k)
      for (std::size_t i = 0; i < map.coefficients[k].texels().size(); ++i)
        worst = std::max<double>(worst, std::abs(fitted.map.coefficients[k].texels()[i] -
                                                 map.coefficients[k].texels()[i]));
    EXPECT_LT(worst, 1e-4) << map.name;
    for (const double rms : fitted.rms) EXPECT_LT(rms, 1e-6) << map.name;
  }
}

TEST(FitMap, TellsTheErrorOfEveryTexelAndChannel) {
  TimeSamples samples{
      "Diffuse", {0, 0.5, 1}, std::vector<Image<float>>(3, Image<float>(2, 1, 3, 0.5f))};
  samples.maps[1].at(1, 0, 2) = 0.8f;  // mean 0.6: residuals 0.1, 0.2, 0.1
  Progress progress;
  const FittedMap fitted = fitMap(samples, {.degree = 0, .weights = {}}, progress);
  EXPECT_NEAR(fitted.error.at(1, 0, 2), std::sqrt(0.02), 1e-6);
  EXPECT_NEAR(fitted.error.at(0, 0, 2), 0, 1e-6);
  ASSERT_EQ(fitted.rms.size(), 3u);
  EXPECT_NEAR(fitted.rms[2], std::sqrt(0.01), 1e-6);
  EXPECT_NEAR(fitted.rms[0], 0, 1e-6);
}

TEST(FitMap, BendsWhatLeavesItsRangeOnlyWhenAsked) {
  const TimeSamples samples = ramp(0.2f, 1.3f);
  Progress progress;
  const FittedMap as_is = fitMap(samples, {.degree = 1, .weights = {}}, progress);
  EXPECT_EQ(as_is.bounded_series, 0);
  EXPECT_NEAR(evaluate(as_is.map, Basis::kMonomial, 1, Clamp::kNone).at(0, 0), 1.3, 1e-5);
  const FittedMap bounded =
      fitMap(samples, {.degree = 1, .weights = {}, .bounded = true}, progress);
  EXPECT_EQ(bounded.bounded_series, 6);
  EXPECT_LE(evaluate(bounded.map, Basis::kMonomial, 1, Clamp::kNone).at(0, 0), 1 + 1e-5);
  EXPECT_GT(bounded.rms[0], 0.01);
}

TEST(FitMap, RefusesADegreeThatTheStepsDoNotCarry) {
  Progress progress;
  EXPECT_THROW(fitMap(ramp(0, 1), {.degree = 3, .weights = {}}, progress), ProcessingError);
}

TEST(FitMap, WritesHighDegreesInLegendrePolynomials) {
  TimeSamples samples{"Diffuse", {}, {}};
  for (int t = 0; t < 20; ++t) {
    samples.times.push_back(t / 19.0);
    samples.maps.emplace_back(1, 1, 1, static_cast<float>(0.5 + 0.3 * std::sin(9 * t / 19.0)));
  }
  Progress progress;
  const FittedMap fitted = fitMap(samples, {.degree = 9, .weights = {}}, progress);
  EXPECT_NEAR(evaluate(fitted.map, Basis::kLegendre, 0.5, Clamp::kNone).at(0, 0),
              0.5 + 0.3 * std::sin(4.5), 1e-3);
}

}  // namespace
}  // namespace patina::stbrdf
