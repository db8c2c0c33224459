// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/staf.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "processing/stbrdf/polynomial_fit.h"
#include "tests/processing/stbrdf/staf_samples.h"

namespace patina::stbrdf {
namespace {

TEST(FitStaf, HoldsAProcessThatOneCurveExplains) {
  const TimeSamples samples = singleProcess("Diffuse", 3, 24, 21);
  Progress progress;
  const StafFit staf = fitStaf(samples, {}, progress);
  const FittedMap cubic = fitMap(samples, {.degree = 3, .weights = {}}, progress);
  ASSERT_EQ(staf.rms.size(), 3u);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_LT(staf.rms[c], 0.01);
    EXPECT_LT(staf.rms[c], cubic.rms[c]);
  }
}

TEST(FitStaf, ReportsTheErrorOfWhatItEvaluatesTo) {
  const TimeSamples samples = singleProcess("Roughness", 1, 16, 15);
  Progress progress;
  const StafFit staf = fitStaf(samples, {}, progress);
  double sum = 0;
  for (std::size_t t = 0; t < samples.times.size(); ++t) {
    const Image<float> at = evaluate(staf.map, samples.times[t], Clamp::kNone);
    for (std::size_t i = 0; i < at.texels().size(); ++i)
      sum += std::pow(at.texels()[i] - samples.maps[t].texels()[i], 2);
  }
  EXPECT_NEAR(std::sqrt(sum / 256 / 15), staf.rms[0], 1e-5);
}

// The failure of the authors' own fit: a small, noisy change on some texels of a map that stands
// still elsewhere ended in a constant curve.
TEST(FitStaf, FindsAFaintProcessOnAFewTexels) {
  TimeSamples samples{"Specular", {}, {}};
  for (int t = 0; t < 25; ++t) {
    samples.times.push_back(t / 24.0);
    Image<float> map(20, 20, 1, 0.04f);
    for (int y = 0; y < 20; ++y)
      for (int x = 0; x < 4; ++x)
        map.at(x, y) +=
            static_cast<float>(0.02 * std::tanh(8 * (samples.times.back() - 0.3 - 0.02 * y)) +
                               0.001 * gaussian(hashSeed(t, x, y)));
    samples.maps.push_back(std::move(map));
  }
  Progress progress;
  const StafFit staf = fitStaf(samples, {}, progress);
  const FittedMap sixth = fitMap(samples, {.degree = 6, .weights = {}}, progress);
  EXPECT_LT(staf.rms[0], 2 * sixth.rms[0]);
  double swing = 0;
  for (const float a : staf.map.channels[0].a.texels())
    swing = std::max<double>(swing, std::abs(a));
  EXPECT_GT(swing, 0.001);
}

TEST(FitStaf, IsTheSameForAnyNumberOfThreads) {
  const TimeSamples samples = singleProcess("Diffuse", 1, 20, 12);
  Progress progress;
  std::vector<std::vector<float>> rates;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    rates.push_back(fitStaf(samples, {}, progress).map.channels[0].rate.texels());
  }
  EXPECT_EQ(rates[0], rates[1]);
  EXPECT_EQ(rates[0], rates[2]);
}

TEST(PolynomialsOf, AreTheSameFunctionsOfTime) {
  const TimeSamples samples = singleProcess("Diffuse", 3, 12, 15);
  Progress progress;
  const StafMap map = fitStaf(samples, {}, progress).map;
  const TimeMap polynomials = polynomialsOf(map);
  for (const double t : {0.0, 0.31, 0.8, 1.0}) {
    const Image<float> a = evaluate(map, t, Clamp::kNone),
                       b = evaluate(polynomials, Basis::kMonomial, t, Clamp::kNone);
    for (std::size_t i = 0; i < a.texels().size(); ++i)
      ASSERT_NEAR(a.texels()[i], b.texels()[i], 2e-5) << t;
  }
}

TEST(FitStaf, NeedsFourTimes) {
  TimeSamples samples = singleProcess("Diffuse", 1, 4, 3);
  Progress progress;
  EXPECT_THROW(fitStaf(samples, {}, progress), ProcessingError);
}

}  // namespace
}  // namespace patina::stbrdf
