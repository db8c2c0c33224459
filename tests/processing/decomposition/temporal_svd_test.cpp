// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/temporal_svd.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "processing/image/failure.h"
#include "processing/image/random.h"

namespace patina::decomposition {
namespace {

struct Matrix {
  std::int64_t m, n;
  std::vector<float> values;
  SampleSource source() const {
    return [this](std::int64_t first, std::int64_t count, std::span<float> block) {
      for (std::int64_t j = 0; j < n; ++j)
        for (std::int64_t i = 0; i < count; ++i) block[j * count + i] = values[(first + i) * n + j];
    };
  }
};

// Sum of `rank` random outer products, their weights falling by 0.7, plus noise.
Matrix planted(std::int64_t m, std::int64_t n, int rank, double noise) {
  Matrix a{m, n, std::vector<float>(static_cast<std::size_t>(m * n))};
  for (std::int64_t i = 0; i < m; ++i)
    for (std::int64_t j = 0; j < n; ++j) {
      double v = noise > 0 ? noise * gaussian(hashSeed(9, i, j)) : 0;
      for (int k = 0; k < rank; ++k)
        v += std::pow(0.7, k) * gaussian(hashSeed(1, k, i)) * gaussian(hashSeed(2, k, j));
      a.values[i * n + j] = static_cast<float>(v);
    }
  return a;
}

double reconstructionError(const Matrix& a, const TemporalSvd& svd) {
  double error = 0, energy = 0;
  for (std::int64_t i = 0; i < a.m; ++i)
    for (std::int64_t j = 0; j < a.n; ++j) {
      double r = svd.mean[j];
      for (int k = 0; k < svd.rank; ++k)
        r += double(svd.scores[i * svd.rank + k]) * svd.basis[j * svd.rank + k];
      const double v = a.values[i * a.n + j];
      error += (v - r) * (v - r);
      energy += (v - svd.mean[j]) * (v - svd.mean[j]);
    }
  return std::sqrt(error / energy);
}

TemporalSvd run(const Matrix& a, const SvdOptions& options) {
  Progress progress;
  return temporalSvd(a.m, a.n, a.source(), options, progress);
}

TEST(TemporalSvd, RecoversAPlantedLowRankExactly) {
  const Matrix a = planted(700, 60, 4, 0);
  const TemporalSvd svd = run(a, {.rank = 4, .block_texels = 64});
  EXPECT_LT(reconstructionError(a, svd), 1e-5);
  EXPECT_LT(svd.relative_error, 1e-6);
  EXPECT_GT(svd.singular_values[3], 1.0);
  EXPECT_LT(svd.singular_values[4], 1e-3);
}

// Short (by the Gram matrix), and long (by a sketch; a ragged end, some texels teach).
TEST(TemporalSvd, OfCodesIsThatOfTheValuesTheyStandFor) {
  constexpr float kStep = 1 / 255.0f;
  const std::pair<std::int64_t, std::int64_t> sizes[] = {{3000, 60}, {66'001, 100}};
  for (const auto& size : sizes) {
    const std::int64_t m = size.first, n = size.second;
    Matrix a = planted(m, n, 4, 0.1);
    std::vector<std::uint8_t> codes(a.values.size());
    for (std::size_t i = 0; i < codes.size(); ++i) {
      codes[i] = static_cast<std::uint8_t>(std::clamp(127 + 30 * a.values[i], 0.0f, 255.0f));
      a.values[i] = codes[i] * kStep;
    }
    const CodeSource source = [&](std::int64_t first, std::int64_t count,
                                  std::span<std::uint8_t> block) {
      for (std::int64_t j = 0; j < n; ++j)
        for (std::int64_t i = 0; i < count; ++i) block[j * count + i] = codes[(first + i) * n + j];
    };
    Progress progress;
    const SvdOptions options{.rank = 4, .centre = true};
    const TemporalSvd of_codes = temporalSvd(m, n, source, kStep, options, progress),
                      of_values = run(a, options);
    EXPECT_NEAR(of_codes.relative_error, of_values.relative_error, 1e-6);
    EXPECT_NEAR(reconstructionError(a, of_codes), of_codes.relative_error, 1e-5) << n << " samples";
    for (int k = 0; k < 4; ++k)
      EXPECT_NEAR(of_codes.singular_values[k], of_values.singular_values[k],
                  1e-6 * of_values.singular_values[0])
          << "of " << n << " samples, " << k;
  }
}

TEST(TemporalSvd, ReportsTheErrorThatAnExplicitReconstructionHas) {
  const Matrix a = planted(900, 90, 6, 0.3);
  for (bool centre : {false, true})
    for (int rank : {1, 3, 6, 20, 90}) {
      const TemporalSvd svd = run(a, {.rank = rank, .centre = centre});
      EXPECT_NEAR(svd.relative_error, reconstructionError(a, svd), 2e-6)
          << "rank " << rank << " centred " << centre;
      EXPECT_EQ(svd.error_of_rank[rank - 1], svd.relative_error);
    }
}

TEST(TemporalSvd, ScoresKeepDistancesBetweenRows) {
  const Matrix a = planted(200, 40, 5, 0);
  const TemporalSvd svd = run(a, {.rank = 5, .centre = true});
  for (int i = 0; i + 1 < 200; ++i) {
    double rows = 0, scores = 0;
    for (int j = 0; j < 40; ++j)
      rows += std::pow(a.values[i * 40 + j] - a.values[(i + 1) * 40 + j], 2);
    for (int k = 0; k < 5; ++k)
      scores += std::pow(svd.scores[i * 5 + k] - svd.scores[(i + 1) * 5 + k], 2);
    EXPECT_NEAR(rows, scores, 1e-4 * rows);
  }
}

TEST(TemporalSvd, BasisIsOrthonormalAndSingularValuesFall) {
  const TemporalSvd svd = run(planted(500, 300, 8, 0.1), {.rank = 10});
  for (int p = 0; p < 10; ++p)
    for (int q = 0; q <= p; ++q) {
      double dot = 0;
      for (int j = 0; j < 300; ++j) dot += double(svd.basis[j * 10 + p]) * svd.basis[j * 10 + q];
      EXPECT_NEAR(dot, p == q ? 1 : 0, 1e-5);
    }
  for (std::size_t i = 1; i < svd.singular_values.size(); ++i)
    EXPECT_LE(svd.singular_values[i], svd.singular_values[i - 1]);
}

// 300 columns: a rank of 10 is sought in a random range, a rank of 80 through the Gram matrix.
TEST(TemporalSvd, FindsTheSameInARandomRangeAsThroughTheGramMatrix) {
  const Matrix a = planted(500, 300, 12, 0.02);
  const TemporalSvd sketched = run(a, {.rank = 10, .centre = true}),
                    exact = run(a, {.rank = 80, .centre = true});
  ASSERT_EQ(sketched.singular_values.size(), 32u);
  ASSERT_EQ(exact.singular_values.size(), 300u);
  for (int k = 0; k < 10; ++k) {
    EXPECT_NEAR(sketched.singular_values[k], exact.singular_values[k],
                1e-5 * exact.singular_values[0]);
    EXPECT_NEAR(sketched.error_of_rank[k], exact.error_of_rank[k], 1e-4);
  }
  for (int i = 0; i < 500; ++i)
    for (int k = 0; k < 10; ++k)
      ASSERT_NEAR(sketched.scores[i * 10 + k], exact.scores[i * 80 + k],
                  1e-3 * exact.singular_values[0] / std::sqrt(500));
}

// Singular values that fall slowly: 60 outer products, the weight of number k 1 / (1 + 0.3 k).
// The first `unlike` texels show something else.
Matrix slowlyFalling(std::int64_t m, std::int64_t n, std::int64_t unlike) {
  Matrix a{m, n, std::vector<float>(static_cast<std::size_t>(m * n))};
  std::vector<double> texel(60);
  for (std::int64_t i = 0; i < m; ++i) {
    for (int k = 0; k < 60; ++k)
      texel[k] = i < unlike ? 0 : gaussian(hashSeed(1, k, i)) / (1 + 0.3 * k);
    for (std::int64_t j = 0; j < n; ++j) {
      double v = 1e-3 * gaussian(hashSeed(9, i, j));
      for (int k = 0; k < 60; ++k) v += texel[k] * gaussian(hashSeed(2, k, j));
      a.values[i * n + j] = static_cast<float>(v);
    }
  }
  return a;
}

// As a rank so high that it goes through the Gram matrix finds them.
void expectSingularValuesWithin(double tolerance, const Matrix& a, std::int64_t block_texels) {
  const TemporalSvd sketched = run(a, {.rank = 15, .block_texels = block_texels}),
                    exact = run(a, {.rank = 60});
  ASSERT_LT(sketched.singular_values.size(), exact.singular_values.size());
  for (int k = 0; k < 15; ++k)
    EXPECT_NEAR(sketched.singular_values[k], exact.singular_values[k],
                tolerance * exact.singular_values[0]);
}

TEST(TemporalSvd, FindsSingularValuesThatFallSlowly) {
  expectSingularValuesWithin(1e-4, slowlyFalling(2000, 200, 0), 500);
}

TEST(TemporalSvd, FindsThemThoughTheFirstBlockShowsSomethingElse) {
  expectSingularValuesWithin(1e-4, slowlyFalling(2000, 200, 500), 500);
}

TEST(TemporalSvd, WeighsColumnsByTheirMeanAndVariance) {
  Matrix a = planted(400, 30, 3, 0.1);
  const Weigh weigh = [](std::span<const double> mean, std::span<const double> variance) {
    std::vector<float> weight;
    for (std::size_t j = 0; j < mean.size(); ++j)
      weight.push_back(static_cast<float>(1 + std::abs(mean[j]) + variance[j]));
    return weight;
  };
  for (bool centre : {false, true}) {
    const TemporalSvd weighed = run(a, {.rank = 5, .centre = centre, .weigh = weigh});
    Matrix b = a;
    for (std::int64_t i = 0; i < b.m; ++i)
      for (std::int64_t j = 0; j < b.n; ++j) b.values[i * b.n + j] *= weighed.weight[j];
    const TemporalSvd plain = run(b, {.rank = 5, .centre = centre});
    for (int k = 0; k < 5; ++k)
      EXPECT_NEAR(weighed.singular_values[k], plain.singular_values[k],
                  1e-5 * plain.singular_values[0]);
    EXPECT_NEAR(weighed.relative_error, plain.relative_error, 1e-5);
    EXPECT_NE(weighed.weight[3], weighed.weight[4]);
  }
}

TEST(TemporalSvd, TakesSamplesThatLieInMemoryByFrames) {
  const Matrix a = planted(1300, 150, 5, 0.1);
  std::vector<float> frames(a.values.size());
  for (std::int64_t i = 0; i < a.m; ++i)
    for (std::int64_t j = 0; j < a.n; ++j) frames[j * a.m + i] = a.values[i * a.n + j];
  Progress progress;
  const TemporalSvd here = temporalSvd(a.m, a.n, frames, {.rank = 7, .centre = true}, progress);
  const TemporalSvd streamed = run(a, {.rank = 7, .centre = true});
  EXPECT_EQ(here.singular_values, streamed.singular_values);
  EXPECT_EQ(here.scores, streamed.scores);
}

TEST(TemporalSvd, ChoosesTheLeastRankBelowTheErrorAsked) {
  const Matrix a = planted(600, 50, 8, 0.05);
  const TemporalSvd chosen = run(a, {.rank = 50, .rank_error = 0.2});
  EXPECT_LT(chosen.relative_error, 0.2);
  ASSERT_GT(chosen.rank, 1);
  EXPECT_GE(run(a, {.rank = chosen.rank - 1}).relative_error, 0.2);
}

TEST(TemporalSvd, StopsAtTheRankGivenWhereTheErrorAskedNeedsMore) {
  EXPECT_EQ(run(planted(300, 50, 20, 1), {.rank = 2, .rank_error = 1e-4}).rank, 2);
}

TEST(TemporalSvd, CopesWithMoreColumnsThanRows) {
  const Matrix a = planted(12, 150, 12, 0.1);
  const TemporalSvd svd = run(a, {.rank = 12});
  EXPECT_LT(reconstructionError(a, svd), 1e-4);
  EXPECT_THROW(run(a, {.rank = 13}), ProcessingError);
}

TEST(TemporalSvd, GivesTheSameBytesForAnyNumberOfThreads) {
  const Matrix a = planted(3000, 130, 6, 0.2);
  const auto with = [&](int threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run(a, {.rank = 9, .block_texels = 1500, .centre = true}); });
  };
  const TemporalSvd one = with(1), four = with(4);
  EXPECT_EQ(one.scores, four.scores);
  EXPECT_EQ(one.basis, four.basis);
  EXPECT_EQ(one.singular_values, four.singular_values);
}

TEST(TemporalSvd, GivesZeroErrorForAConstantSequenceThatIsCentred) {
  const Matrix a{40, 7, std::vector<float>(280, 0.5f)};
  const TemporalSvd svd = run(a, {.rank = 2, .centre = true});
  EXPECT_NEAR(svd.relative_error, 0, 1e-6);
  for (float s : svd.scores) EXPECT_NEAR(s, 0, 1e-5);
}

TEST(TemporalSvd, RefusesNaN) {
  Matrix a = planted(50, 10, 2, 0.1);
  a.values[123] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THROW(run(a, {.rank = 2}), ProcessingError);
}

TEST(TemporalSvd, RefusesImpossibleOptionsWithFieldAndRange) {
  const Matrix a = planted(50, 10, 2, 0.1);
  try {
    run(a, {.rank = 11});
    FAIL();
  } catch (const ProcessingError& e) {
    EXPECT_STREQ(e.what(), "singular value decomposition: rank is 11; allowed: 1 to 10");
  }
  EXPECT_THROW(run(a, {.rank = 2, .rank_error = -1}), ProcessingError);
  EXPECT_THROW(run(a, {.rank = 2, .block_texels = 0}), ProcessingError);
}

TEST(TemporalSvd, StopsWhenAsked) {
  const Matrix a = planted(50, 10, 2, 0.1);
  Progress progress;
  progress.askToStop();
  EXPECT_THROW(temporalSvd(a.m, a.n, a.source(), {.rank = 2}, progress), Stopped);
}

}  // namespace
}  // namespace patina::decomposition
