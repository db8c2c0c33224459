// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/strip_cut.h"

#include <gtest/gtest.h>

#include <limits>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

Image<double> randomDifference(SizePx size, std::uint64_t seed) {
  Image<double> d(size.width, size.height, 1);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) d.at(x, y) = uniform(hashSeed(seed, x, y));
  return d;
}

// Every path from row to row.
double leastFrom(const Image<double>& d, int x, int y) {
  if (y + 1 == d.height()) return d.at(x, y);
  double least = std::numeric_limits<double>::infinity();
  for (int next = std::max(0, x - 1); next <= std::min(d.width() - 1, x + 1); ++next)
    least = std::min(least, leastFrom(d, next, y + 1));
  return d.at(x, y) + least;
}

TEST(StripCut, FindsTheLeastOfAllPaths) {
  for (int seed = 0; seed < 20; ++seed) {
    const Image<double> d = randomDifference({4, 6}, seed);
    double least = std::numeric_limits<double>::infinity();
    for (int x = 0; x < 4; ++x) least = std::min(least, leastFrom(d, x, 0));
    EXPECT_DOUBLE_EQ(cutAlongRows(d.view(), {0, 0, 4, 6}), least);
  }
}

TEST(StripCut, CutsColumnsAsItCutsRowsOfTheTransposed) {
  const Image<double> d = randomDifference({9, 5}, 3);
  Image<double> transposed(5, 9, 1);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 9; ++x) transposed.at(y, x) = d.at(x, y);
  EXPECT_DOUBLE_EQ(cutAlongColumns(d.view(), {2, 1, 6, 3}),
                   cutAlongRows(transposed.view(), {1, 2, 3, 6}));
}

TEST(StripCut, LooksAtTheStripOnly) {
  Image<double> d(8, 8, 1, 0.0);
  for (int y = 0; y < 8; ++y) d.at(2, y) = d.at(3, y) = 1;
  EXPECT_EQ(cutAlongRows(d.view(), {2, 0, 2, 8}), 8);
  EXPECT_EQ(cutAlongRows(d.view(), {2, 3, 3, 2}), 0);
  EXPECT_EQ(cutAlongRows(d.view(), {0, 0, 0, 8}), 0);
}

}  // namespace
}  // namespace patina::patch
