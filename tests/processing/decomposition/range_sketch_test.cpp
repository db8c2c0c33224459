// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/range_sketch.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::decomposition {
namespace {

constexpr Index kTexels = 1100, kTimes = 60, kColumns = 6;

// [kTimes][kTexels]: four outer products, and a mean of its own for every row.
std::vector<float> planted() {
  std::vector<float> out(kTimes * kTexels);
  for (Index j = 0; j < kTimes; ++j)
    for (Index i = 0; i < kTexels; ++i) {
      double v = 0.05 * static_cast<double>(j);
      for (Index k = 0; k < 4; ++k) v += gaussian(hashSeed(1, k, i)) * gaussian(hashSeed(2, k, j));
      out[j * kTexels + i] = static_cast<float>(v);
    }
  return out;
}

std::vector<double> meanOf(std::span<const float> all) {
  std::vector<double> mean(kTimes);
  for (Index j = 0; j < kTimes; ++j)
    for (Index i = 0; i < kTexels; ++i) mean[j] += all[j * kTexels + i] / double{kTexels};
  return mean;
}

TEST(RangeSketch, SpansAllThatIsThereOnceTheMeanIsOut) {
  const std::vector<float> all = planted();
  const std::vector<double> mean = meanOf(all);
  RangeSketch sketch(kTexels, kTimes, randomColumns(kTimes, kColumns));
  sketch.add(0, {.data = all.data(), .count = kTexels, .stride = kTexels});
  const std::vector<double> basis = sketch.factors(mean, std::vector<float>(kTimes, 1)).basis;
  double left = 0, whole = 0;
  for (Index i = 0; i < kTexels; i += 97) {
    std::vector<double> texel(kTimes);
    for (Index j = 0; j < kTimes; ++j) texel[j] = all[j * kTexels + i] - mean[j];
    for (const double v : texel) whole += v * v;
    for (Index k = 0; k < kColumns; ++k) {
      double along = 0;
      for (Index j = 0; j < kTimes; ++j) along += texel[j] * basis[j * kColumns + k];
      for (Index j = 0; j < kTimes; ++j) texel[j] -= along * basis[j * kColumns + k];
    }
    for (const double v : texel) left += v * v;
  }
  EXPECT_LT(std::sqrt(left / whole), 1e-4);
}

// More texels than are needed to teach how they hang on Y: where they lie differently, as here, the
// part that lies outside of Omega's range is found all the same.
TEST(RangeSketch, FindsOfManyTexelsTheSameFromSome) {
  constexpr Index kMany = 150000, kFew = 12;
  std::vector<float> all(kFew * kMany);
  std::vector<double> mean(kFew), energy(kFew * kFew);
  for (Index i = 0; i < kMany; ++i)
    for (Index k = 0; k < 3; ++k) {
      const double of_texel = gaussian(hashSeed(3, k, i)) * (i > kMany / 3 ? 1 : 2);
      for (Index j = 0; j < kFew; ++j)
        all[j * kMany + i] += static_cast<float>(of_texel * gaussian(hashSeed(4, k, j)));
    }
  double whole = 0;
  for (Index j = 0; j < kFew; ++j) {
    for (Index i = 0; i < kMany; ++i) mean[j] += all[j * kMany + i] / double{kMany};
    for (Index i = 0; i < kMany; ++i) whole += std::pow(all[j * kMany + i] - mean[j], 2);
  }
  RangeSketch sketch(kMany, kFew, randomColumns(kFew, 4));
  for (Index first = 0; first < kMany; first += 2048) {
    const Index count = std::min<Index>(2048, kMany - first);
    sketch.add(first, {.data = all.data() + first, .count = count, .stride = kMany});
  }
  const RangeSketch::Factors found = sketch.factors(mean, std::vector<float>(kFew, 1));
  double sum = 0;
  for (const double s : found.squares) sum += s;
  EXPECT_NEAR(sum / whole, 1, 1e-5);
  EXPECT_LT(found.squares[3], 1e-6 * whole);
}

TEST(Scores, AreProjectionsLessTheirOffsetAndTurnAsTold) {
  const std::vector<float> all = planted();
  std::vector<float> projection(kTimes * 2);
  for (std::size_t i = 0; i < projection.size(); ++i)
    projection[i] = static_cast<float>(gaussian(hashSeed(7, i)));
  const std::vector<double> offset{3, -4};
  Scores scores(kTexels, 2);
  scores.add(0, {.data = all.data(), .count = 700, .stride = kTexels}, kTimes, projection);
  scores.add(700, {.data = all.data() + 700, .count = kTexels - 700, .stride = kTexels}, kTimes,
             projection);
  scores.subtract(offset);
  const std::vector<double> gram = scores.gram(std::vector<Range>{{0, 500}, {500, kTexels - 500}});
  std::vector<double> own(kTexels * 2);
  for (Index i = 0; i < kTexels; ++i)
    for (Index k = 0; k < 2; ++k) {
      own[i * 2 + k] = -offset[k];
      for (Index j = 0; j < kTimes; ++j)
        own[i * 2 + k] += double{all[j * kTexels + i]} * projection[j * 2 + k];
    }
  double cross = 0;
  for (Index i = 0; i < kTexels; ++i) cross += own[i * 2] * own[i * 2 + 1];
  EXPECT_NEAR(gram[2], cross, 1e-4 * std::sqrt(gram[0] * gram[3]));
  // A quarter turn: what was second comes first.
  const std::vector<float> turned = scores.rotated(std::vector<float>{0, -1, 1, 0}, 2);
  for (const Index i : {Index{0}, Index{699}, Index{700}, kTexels - 1}) {
    EXPECT_NEAR(turned[i * 2], own[i * 2 + 1], 1e-3);
    EXPECT_NEAR(turned[i * 2 + 1], -own[i * 2], 1e-3);
  }
}

}  // namespace
}  // namespace patina::decomposition
