// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/projection.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <bit>
#include <cmath>
#include <cstdlib>
#include <iostream>

#include "processing/image/random.h"
#include "tests/support/child.h"
#include "tests/support/places.h"

namespace patina::stbrdf {
namespace {

constexpr int kSteps = 33;
constexpr std::size_t kCount = 64 * 5 + 37;

std::vector<double> times() {
  std::vector<double> out;
  for (int t = 0; t < kSteps; ++t) out.push_back(t / (kSteps - 1.0));
  return out;
}

// Curves such as ageing gives them, with noise, [t][series].
std::vector<std::vector<float>> curves() {
  std::vector<std::vector<float>> out(kSteps, std::vector<float>(kCount));
  for (int t = 0; t < kSteps; ++t)
    for (std::size_t i = 0; i < kCount; ++i) {
      const double at = 0.2 + 0.6 * uniform(hashSeed(1, i));
      out[t][i] = static_cast<float>(0.5 + 0.3 * std::tanh(6 * (t / (kSteps - 1.0) - at)) +
                                     0.01 * gaussian(hashSeed(2, i, t)));
    }
  return out;
}

struct Planes {
  std::vector<std::vector<float>> values;
  std::vector<float*> out() {
    std::vector<float*> p;
    for (auto& v : values) p.push_back(v.data());
    return p;
  }
  std::vector<const float*> in() const {
    std::vector<const float*> p;
    for (const auto& v : values) p.push_back(v.data());
    return p;
  }
};

Planes fitted(const TimeFit& fit, Basis basis, const Planes& samples) {
  Planes out{std::vector<std::vector<float>>(fit.degree() + 1, std::vector<float>(kCount))};
  Projection(fit, basis).apply(samples.in(), out.out(), kCount);
  return out;
}

double valueAt(const Planes& c, Basis basis, std::size_t i, double t) {
  double b[kTermsMax], sum = 0;
  basisValues(basis, static_cast<int>(c.values.size()) - 1, t, b);
  for (std::size_t k = 0; k < c.values.size(); ++k) sum += b[k] * c.values[k][i];
  return sum;
}

double optimumAt(const TimeFit& fit, const Planes& samples, std::size_t i, double t) {
  double b[kTermsMax], sum = 0;
  basisValues(Basis::kLegendre, fit.degree(), t, b);
  for (int k = 0; k <= fit.degree(); ++k)
    for (int u = 0; u < kSteps; ++u)
      sum += b[k] * fit.projection()[k * kSteps + u] * samples.values[u][i];
  return sum;
}

TEST(Projection, EqualsTheLeastSquaresOptimumInFloat64) {
  const Planes samples{curves()};
  for (const int degree : {3, 4, 5}) {
    const TimeFit fit(times(), {}, degree);
    for (const Basis basis : {Basis::kMonomial, Basis::kLegendre}) {
      const Planes c = fitted(fit, basis, samples);
      for (std::size_t i = 0; i < kCount; ++i)
        for (const double t : {0.0, 0.25, 0.5, 0.9, 1.0})
          ASSERT_NEAR(valueAt(c, basis, i, t), optimumAt(fit, samples, i, t), 1e-6)
              << degree << " " << nameOf(basis) << " " << i;
    }
  }
}

TEST(Projection, RecoversRandomPolynomialsOfEveryDegree) {
  for (int degree = 0; degree <= kDegreeMax; ++degree) {
    Planes truth{std::vector<std::vector<float>>(degree + 1, std::vector<float>(kCount))};
    for (int k = 0; k <= degree; ++k)
      for (std::size_t i = 0; i < kCount; ++i)
        truth.values[k][i] =
            static_cast<float>((k == 0 ? 0.5 : 0) + 0.2 * gaussian(hashSeed(5, k, i)) / (1 + k));
    Planes samples{std::vector<std::vector<float>>(kSteps, std::vector<float>(kCount))};
    for (int t = 0; t < kSteps; ++t)
      for (std::size_t i = 0; i < kCount; ++i)
        samples.values[t][i] =
            static_cast<float>(valueAt(truth, Basis::kLegendre, i, t / (kSteps - 1.0)));
    const Basis basis = basisOf(degree);
    const Planes c = fitted(TimeFit(times(), {}, degree), basis, samples);
    for (std::size_t i = 0; i < kCount; ++i)
      for (double t = 0; t <= 1; t += 0.05)
        ASSERT_NEAR(valueAt(c, basis, i, t), valueAt(truth, Basis::kLegendre, i, t), 1e-4)
            << degree;
  }
}

TEST(Projection, LeavesNoSeriesOutAndTouchesNothingBeyond) {
  const TimeFit fit(times(), {}, 2);
  for (const std::size_t count : {std::size_t{1}, std::size_t{63}, std::size_t{64}, kCount - 1}) {
    const Planes samples{
        std::vector<std::vector<float>>(kSteps, std::vector<float>(kCount, 0.25f))};
    Planes out{std::vector<std::vector<float>>(3, std::vector<float>(kCount, 9))};
    Projection(fit, Basis::kMonomial).apply(samples.in(), out.out(), count);
    for (std::size_t i = 0; i < count; ++i) ASSERT_NEAR(out.values[0][i], 0.25, 1e-6);
    for (std::size_t i = count; i < kCount; ++i) ASSERT_EQ(out.values[0][i], 9) << count;
  }
}

// A hash of everything that is fitted, for the tests that run this program again.
std::uint64_t hashOfFits() {
  const Planes samples{curves()};
  std::uint64_t hash = 1;
  for (int degree = 0; degree <= kDegreeMax; ++degree)
    for (const Basis basis : {Basis::kMonomial, Basis::kLegendre}) {
      const TimeFit fit(times(), {}, degree);
      for (const auto& plane : fitted(fit, basis, samples).values)
        for (const float v : plane) hash = hashSeed(hash, std::bit_cast<std::uint32_t>(v));
    }
  return hash;
}

TEST(Projection, GivesTheSameBytesForAnyNumberOfThreads) {
  std::vector<std::uint64_t> hashes;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    hashes.push_back(hashOfFits());
  }
  EXPECT_EQ(hashes[0], hashes[1]);
  EXPECT_EQ(hashes[0], hashes[2]);
}

// Runs this program again on one path; empty where the processor does not have it.
std::string hashOnPath(const std::string& path) {
  const auto child = testing::run({testing::programFolder() / "stbrdf_test",
                                   "--gtest_filter=Projection.GivesTheSameBytesOnEverySimdPath"},
                                  {"PATINA_SIMD=" + path, "PATINA_PRINT_HASH=1", "GTEST_OUTPUT="});
  const std::size_t at = child.out.find("hash ");
  return at == std::string::npos ? "" : child.out.substr(at, child.out.find('\n', at) - at);
}

TEST(Projection, GivesTheSameBytesOnEverySimdPath) {
  if (std::getenv("PATINA_PRINT_HASH")) {
    const std::uint64_t hash = hashOfFits();
    std::cout << "\nhash " << hash << std::endl;
    return;
  }
  const std::string baseline = hashOnPath("baseline");
  EXPECT_NE(baseline, "");
  for (const char* path : {"avx2", "avx512"}) {
    const std::string hash = hashOnPath(path);
    EXPECT_TRUE(hash.empty() || hash == baseline) << path;
  }
}

TEST(ResidualRms, IsTheWeightedErrorOfThePolynomial) {
  Planes samples{std::vector<std::vector<float>>(3, std::vector<float>(70, 0.5f))};
  samples.values[1].assign(70, 0.8f);
  Planes half{std::vector<std::vector<float>>(1, std::vector<float>(70, 0.5f))};
  const TimeFit fit(std::vector<double>{0, 0.5, 1}, std::vector<double>{1, 2, 1}, 0);
  std::vector<float> rms(70);
  residualRms(fit, Basis::kMonomial, samples.in(), half.in(), rms);
  for (const float v : rms) EXPECT_NEAR(v, 0.3 * std::sqrt(0.5), 1e-6);
}

}  // namespace
}  // namespace patina::stbrdf
