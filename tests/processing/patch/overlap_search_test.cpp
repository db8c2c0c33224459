// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/overlap_search.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <limits>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

// Smooth in space, channels falling in strength: as scores of a decomposition are. `offset` lifts
// all values, which is what rounding suffers from.
Image<float> smoothFeatures(SizePx size, int channels, std::uint64_t seed, double offset = 0) {
  Image<float> f(size.width, size.height, channels);
  for (int c = 0; c < channels; ++c)
    for (int wave = 0; wave < 8; ++wave) {
      const std::uint64_t s = hashSeed(seed, c, wave);
      const double kx = 0.5 * gaussian(hashSeed(s, 1)), ky = 0.5 * gaussian(hashSeed(s, 2)),
                   phase = 6.28 * uniform(hashSeed(s, 3));
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          f.at(x, y, c) += static_cast<float>(std::sin(kx * x + ky * y + phase) / (1 + c));
    }
  for (float& v : f.texels()) v += static_cast<float>(offset);
  return f;
}

struct Query {
  Image<float> target;
  Image<std::uint8_t> known;
  Overlap overlap() const { return {target.view(), known.view()}; }
};

// An L-shaped overlap out of another texture.
Query lShaped(SizePx block, int overlap, int channels, std::uint64_t seed, double offset = 0) {
  Query q{smoothFeatures(block, channels, seed + 77, offset),
          Image<std::uint8_t>(block.width, block.height, 1)};
  for (int y = 0; y < block.height; ++y)
    for (int x = 0; x < block.width; ++x) q.known.at(x, y) = x < overlap || y < overlap;
  return q;
}

std::vector<Candidate> bruteForce(ImageView<const float> f, const Query& q, SizePx block,
                                  const SearchTerms& terms) {
  std::vector<Candidate> all;
  double least = std::numeric_limits<double>::infinity();
  for (int y = 0; y + block.height <= f.height; ++y)
    for (int x = 0; x + block.width <= f.width; ++x) {
      double sum = 0;
      for (int j = 0; j < block.height; ++j)
        for (int i = 0; i < block.width; ++i)
          for (int c = 0; c < f.channels && q.known.at(i, j); ++c)
            sum += std::pow(double(f.at(x + i, y + j, c)) - q.target.at(i, j, c), 2);
      const double weight = terms.weight.empty() ? 1 : terms.weight.at(x, y);
      all.push_back({x, y, weight * (terms.floor + sum)});
      least = std::min(least, all.back().cost);
    }
  std::erase_if(all,
                [&](const Candidate& c) { return !(c.cost <= (1 + terms.tolerance) * least); });
  return all;
}

void expectSame(const std::vector<Candidate>& found, const std::vector<Candidate>& wanted) {
  ASSERT_EQ(found.size(), wanted.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].x, wanted[i].x);
    EXPECT_EQ(found[i].y, wanted[i].y);
    EXPECT_NEAR(found[i].cost, wanted[i].cost, 1e-4 * wanted[i].cost + 1e-6);
  }
}

TEST(OverlapSearch, FindsTheWholeToleranceSetOfBruteForce) {
  for (int trial = 0; trial < 12; ++trial) {
    const SizePx block = trial % 3 == 0 ? SizePx{8, 20} : SizePx{12, 12};
    const Image<float> f = smoothFeatures({61, 53}, 1 + trial % 5, trial);
    const Query q = lShaped(block, 3, f.channels(), trial);
    OverlapSearch search(f.view(), block);
    for (double tolerance : {0.0, 0.1, 1.0}) {
      const SearchTerms terms{tolerance, 0.01 * trial, {}};
      expectSame(search.candidates(q.overlap(), terms), bruteForce(f.view(), q, block, terms));
    }
  }
}

TEST(OverlapSearch, FindsTheSameSetThoughValuesLieFarFromZero) {
  const Image<float> f = smoothFeatures({64, 64}, 4, 5, 50);
  const Query q = lShaped({16, 16}, 4, 4, 5, 50);
  OverlapSearch search(f.view(), {16, 16});
  const SearchTerms terms{0.1, 0, {}};
  expectSame(search.candidates(q.overlap(), terms), bruteForce(f.view(), q, {16, 16}, terms));
}

TEST(OverlapSearch, FindsAPieceOfTheSourceExactly) {
  const Image<float> f = smoothFeatures({70, 60}, 6, 1);
  Query q = lShaped({16, 16}, 4, 6, 1);
  q.target = copyOf(f.view().crop({31, 22, 16, 16}));
  OverlapSearch search(f.view(), {16, 16});
  const auto found = search.candidates(q.overlap(), {0.1, 0, {}});
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].x, 31);
  EXPECT_EQ(found[0].y, 22);
  EXPECT_EQ(found[0].cost, 0);
}

TEST(OverlapSearch, HoldsToWeightsAndForbiddenCorners) {
  const Image<float> f = smoothFeatures({48, 48}, 3, 8);
  const Query q = lShaped({12, 12}, 3, 3, 8);
  OverlapSearch search(f.view(), {12, 12});
  Image<float> weight(37, 37, 1, 1.0f);
  for (int y = 0; y < 37; ++y)
    for (int x = 0; x < 37; ++x) {
      weight.at(x, y) += static_cast<float>(uniform(hashSeed(4, x, y)));
      if ((x + y) % 3 == 0) weight.at(x, y) = std::numeric_limits<float>::infinity();
    }
  const SearchTerms terms{0.3, 0.5, std::as_const(weight).view()};
  const auto found = search.candidates(q.overlap(), terms);
  expectSame(found, bruteForce(f.view(), q, {12, 12}, terms));
  for (const Candidate& c : found) EXPECT_NE((c.x + c.y) % 3, 0);
}

TEST(OverlapSearch, FindsNothingWhereNothingIsAllowed) {
  const Image<float> f = smoothFeatures({20, 20}, 2, 8);
  OverlapSearch search(f.view(), {12, 12});
  const Image<float> weight(9, 9, 1, std::numeric_limits<float>::infinity());
  EXPECT_TRUE(
      search.candidates(lShaped({12, 12}, 3, 2, 8).overlap(), {0.1, 0, weight.view()}).empty());
}

TEST(OverlapSearch, TakesABlockAsLargeAsTheSource) {
  const Image<float> f = smoothFeatures({9, 7}, 2, 3);
  OverlapSearch search(f.view(), {9, 7});
  EXPECT_EQ(search.candidates(lShaped({9, 7}, 2, 2, 3).overlap(), {}).size(), 1u);
}

TEST(OverlapSearch, GivesTheSameForAnyNumberOfThreads) {
  const Image<float> f = smoothFeatures({90, 80}, 8, 2);
  const Query q = lShaped({16, 16}, 4, 8, 2);
  const auto with = [&](int threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(threads);
    return arena.execute([&] {
      OverlapSearch search(f.view(), {16, 16});
      return search.candidates(q.overlap(), {2.0, 0, {}});
    });
  };
  const auto one = with(1), four = with(4);
  ASSERT_EQ(one.size(), four.size());
  ASSERT_GT(one.size(), 10u);
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].cost, four[i].cost);
}

}  // namespace
}  // namespace patina::patch
