// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/grid_cut.h"

#include <gtest/gtest.h>

#include <limits>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

struct Problem {
  Image<double> difference;
  Image<Side> side;
};

double costOf(const Problem& p, const Image<std::uint8_t>& take_new) {
  const auto pair = [&](int x, int y, int u, int v) {
    if (take_new.at(x, y) == take_new.at(u, v)) return 0.0;
    const double s = p.difference.at(x, y), t = p.difference.at(u, v);
    if (s < 0 && t < 0) return 0.0;
    return s < 0 ? 2 * t : t < 0 ? 2 * s : s + t;
  };
  double sum = 0;
  for (int y = 0; y < p.side.height(); ++y)
    for (int x = 0; x < p.side.width(); ++x) {
      if (x + 1 < p.side.width()) sum += pair(x, y, x + 1, y);
      if (y + 1 < p.side.height()) sum += pair(x, y, x, y + 1);
    }
  return sum;
}

// Every assignment of the free texels.
double leastCost(const Problem& p) {
  std::vector<std::pair<int, int>> open;
  Image<std::uint8_t> take(p.side.width(), p.side.height(), 1);
  for (int y = 0; y < p.side.height(); ++y)
    for (int x = 0; x < p.side.width(); ++x) {
      take.at(x, y) = p.side.at(x, y) == Side::kNew;
      if (p.side.at(x, y) == Side::kFree) open.push_back({x, y});
    }
  double least = std::numeric_limits<double>::infinity();
  for (unsigned bits = 0; bits < 1u << open.size(); ++bits) {
    for (std::size_t i = 0; i < open.size(); ++i)
      take.at(open[i].first, open[i].second) = bits >> i & 1;
    least = std::min(least, costOf(p, take));
  }
  return least;
}

// Old beyond the left and top edges, nothing yet in the rest: an L-shaped overlap of 2.
Problem lShaped(int width, int height, std::uint64_t seed) {
  Problem p{Image<double>(width, height, 1, -1), Image<Side>(width, height, 1, Side::kNew)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (x < 3 || y < 3) {
        p.difference.at(x, y) = std::floor(20 * uniform(hashSeed(seed, x, y)));
        p.side.at(x, y) = x == 0 || y == 0 ? Side::kOld : Side::kFree;
      }
  return p;
}

GridCut cut(const Problem& p) { return minimumCut(p.difference.view(), p.side.view()); }

TEST(MinimumCut, CostsNoMoreThanAnyAssignmentOnTinyOverlaps) {
  for (int seed = 0; seed < 40; ++seed) {
    const Problem p = lShaped(5, 5, seed);
    const GridCut found = cut(p);
    EXPECT_DOUBLE_EQ(found.cost, leastCost(p)) << "seed " << seed;
    EXPECT_DOUBLE_EQ(found.cost, costOf(p, found.take_new));
  }
}

TEST(MinimumCut, CostsNoMoreThanAnyAssignmentForAnyPattern) {
  for (int seed = 0; seed < 60; ++seed) {
    Problem p{Image<double>(4, 4, 1), Image<Side>(4, 4, 1, Side::kFree)};
    for (int i = 0; i < 16; ++i) {
      p.difference.texels()[i] = uniform(hashSeed(seed, i, 1));
      const double what = uniform(hashSeed(seed, i, 2));
      if (what < 0.15) p.side.texels()[i] = Side::kOld;
      if (what > 0.85) p.side.texels()[i] = Side::kNew, p.difference.texels()[i] = -1;
    }
    EXPECT_NEAR(cut(p).cost, leastCost(p), 1e-9) << "seed " << seed;
  }
}

TEST(MinimumCut, KeepsFixedTexelsWhereTheyAre) {
  const Problem p = lShaped(20, 30, 3);
  const GridCut found = cut(p);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 20; ++x) {
      if (p.side.at(x, y) == Side::kFree) continue;
      ASSERT_EQ(found.take_new.at(x, y), p.side.at(x, y) == Side::kNew) << x << "," << y;
    }
}

TEST(MinimumCut, FollowsAPathWithoutDifferenceThroughABend) {
  // A free valley that goes right, down and right again: no cut by rows or columns alone finds it.
  Problem p{Image<double>(9, 9, 1, 1.0), Image<Side>(9, 9, 1, Side::kFree)};
  for (int x = 0; x < 9; ++x) p.side.at(x, 0) = Side::kOld, p.side.at(x, 8) = Side::kNew;
  const auto valley = [&](int x, int y) { p.difference.at(x, y) = 0; };
  for (int x = 0; x <= 4; ++x) valley(x, 2), valley(x, 3);
  for (int y = 2; y <= 6; ++y) valley(4, y), valley(5, y);
  for (int x = 4; x < 9; ++x) valley(x, 5), valley(x, 6);
  EXPECT_EQ(cut(p).cost, 0);
}

TEST(MinimumCut, CountsADifferenceTwiceBesideWhatHasOnlyOneSide) {
  Problem p{Image<double>(3, 1, 1), Image<Side>(3, 1, 1, Side::kFree)};
  p.difference.texels() = {0.0, 7.0, -1.0};
  p.side.at(0, 0) = Side::kOld;
  p.side.at(2, 0) = Side::kNew;
  const GridCut found = cut(p);  // 0|7 costs 7; 7|absent would cost 14
  EXPECT_EQ(found.cost, 7);
  EXPECT_EQ(found.take_new.at(1, 0), 1);
  EXPECT_EQ(found.cut_edges, 1);
}

TEST(MinimumCut, KeepsAllOldWhereNothingNewIsFixed) {
  Problem p{Image<double>(4, 4, 1, 1.0), Image<Side>(4, 4, 1, Side::kFree)};
  p.side.at(0, 0) = Side::kOld;
  const GridCut found = cut(p);
  EXPECT_EQ(found.cost, 0);
  for (auto t : found.take_new.texels()) EXPECT_EQ(t, 0);
}

TEST(MinimumCut, TakesTheShortestBoundaryWhereAllAreFree) {
  Problem p{Image<double>(8, 8, 1, 0.0), Image<Side>(8, 8, 1, Side::kFree)};
  for (int x = 0; x < 8; ++x) p.side.at(x, 0) = Side::kOld, p.side.at(x, 7) = Side::kNew;
  EXPECT_EQ(cut(p).cut_edges, 8);
}

TEST(MinimumChoice, CostsNoMoreThanAnyOfAllChoices) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    constexpr int kWidth = 4, kHeight = 3;
    GridTerms terms{Image<double>(kWidth, kHeight, 1), Image<double>(kWidth, kHeight, 1),
                    Image<double>(kWidth, kHeight, 1)};
    for (int i = 0; i < kWidth * kHeight; ++i) {
      terms.one.texels()[i] = std::floor(21 * uniform(hashSeed(seed, i, 1))) - 10;
      terms.right.texels()[i] = std::floor(8 * uniform(hashSeed(seed, i, 2)));
      terms.down.texels()[i] = std::floor(8 * uniform(hashSeed(seed, i, 3)));
    }
    const auto cost = [&](const std::vector<std::uint8_t>& x) {
      double sum = 0;
      for (int i = 0; i < kWidth * kHeight; ++i) {
        sum += x[i] ? terms.one.texels()[i] : 0;
        if (i % kWidth + 1 < kWidth && !x[i] && x[i + 1]) sum += terms.right.texels()[i];
        if (i + kWidth < kWidth * kHeight && !x[i] && x[i + kWidth]) sum += terms.down.texels()[i];
      }
      return sum;
    };
    double least = std::numeric_limits<double>::infinity();
    for (unsigned bits = 0; bits < 1u << (kWidth * kHeight); ++bits) {
      std::vector<std::uint8_t> x;
      for (int i = 0; i < kWidth * kHeight; ++i) x.push_back(bits >> i & 1);
      least = std::min(least, cost(x));
    }
    EXPECT_EQ(cost(minimumChoice(terms).texels()), least) << "seed " << seed;
  }
}

// Five columns between an old and a new one: edges to the right cost least in the middle, edges
// down cost nothing, so that every row is cut there.
TEST(MinimumCut, TakesCostsThatDifferByDirection) {
  EdgeCosts costs{Image<double>(7, 4, 1, 5.0), Image<double>(7, 4, 1)};
  Image<Side> side(7, 4, 1);
  for (int y = 0; y < 4; ++y) {
    side.at(0, y) = Side::kOld;
    side.at(6, y) = Side::kNew;
    costs.right.at(1 + y, y) = 2;
  }
  const GridCut cut = minimumCut(costs, std::as_const(side).view());
  EXPECT_EQ(cut.cost, 4 * 2);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 7; ++x) EXPECT_EQ(cut.take_new.at(x, y), x > 1 + y);
}

}  // namespace
}  // namespace patina::patch
