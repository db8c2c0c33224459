// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/gram_matrix.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::decomposition {
namespace {

constexpr Index kTexels = 1300, kTimes = 70;  // more than a panel and a tile, a multiple of neither

// [kTimes][kTexels], every row about a mean of its own.
std::vector<float> samples() {
  std::vector<float> out(kTimes * kTexels);
  for (Index j = 0; j < kTimes; ++j)
    for (Index i = 0; i < kTexels; ++i)
      out[j * kTexels + i] =
          static_cast<float>(gaussian(hashSeed(3, i, j)) + 0.1 * static_cast<double>(j));
  return out;
}

// Of rows a and b, less their means and times their weights.
double product(std::span<const float> all, Index a, Index b, std::span<const double> mean,
               std::span<const float> weight) {
  double sum = 0;
  for (Index i = 0; i < kTexels; ++i)
    sum += (all[a * kTexels + i] - mean[a]) * (all[b * kTexels + i] - mean[b]);
  return sum * weight[a] * weight[b];
}

TEST(GramMatrix, HasTheSumsOfTheCentredWeighedRowsForItsEigenvalues) {
  const std::vector<float> all = samples();
  std::vector<double> mean(kTimes);
  std::vector<float> weight(kTimes);
  for (Index j = 0; j < kTimes; ++j) {
    for (Index i = 0; i < kTexels; ++i) mean[j] += all[j * kTexels + i] / double{kTexels};
    weight[j] = 1 + static_cast<float>(j % 3);
  }
  GramMatrix gram(kTimes);
  for (const Index first : {Index{0}, Index{900}})  // in blocks of different lengths
    gram.add(
        {.data = all.data() + first, .count = first == 0 ? 900 : kTexels - 900, .stride = kTexels});
  gram.centreAndWeigh(kTexels, mean, weight);
  double trace = 0;
  for (Index j = 0; j < kTimes; ++j) trace += product(all, j, j, mean, weight);
  EXPECT_NEAR(gram.trace() / trace, 1, 1e-9);

  const GramMatrix::Eigen eigen = std::move(gram).eigen();
  for (Index k = 1; k < kTimes; ++k) EXPECT_LE(eigen.values[k], eigen.values[k - 1]);
  for (const Index a : {Index{0}, Index{33}, kTimes - 1})
    for (const Index b : {Index{5}, kTimes - 1}) {
      double again = 0;
      for (Index k = 0; k < kTimes; ++k)
        again += eigen.values[k] * eigen.vectors[k * kTimes + a] * eigen.vectors[k * kTimes + b];
      EXPECT_NEAR(again, product(all, a, b, mean, weight), 1e-8 * trace) << a << " " << b;
    }
}

}  // namespace
}  // namespace patina::decomposition
