// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/lanes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

namespace patina::patch {
namespace {

// Among them: bands that would be one tile wide, and a last one that would be where it wraps.
constexpr SizePx kSizes[] = {{512, 512}, {300, 700}, {90, 90}, {12, 2000},
                             {208, 640}, {33, 5},    {5, 5}};

TEST(Lanes, CoverEachTexelOnceAPass) {
  for (const SizePx size : kSizes)
    for (const bool forward : {true, false}) {
      const Lanes lanes(size, false);
      std::vector<int> seen(static_cast<std::size_t>(size.width) *
                            static_cast<std::size_t>(size.height));
      for (int step = 0; step < lanes.steps(); ++step)
        for (int lane = 0; lane < lanes.count(); ++lane) {
          const Tile tile = lanes.tile(lane, step, forward);
          for (int y = tile.y0; y < tile.y1; ++y)
            for (int x = tile.x0; x < tile.x1; ++x)
              ++seen[static_cast<std::size_t>(y) * static_cast<std::size_t>(size.width) +
                     static_cast<std::size_t>(x)];
        }
      EXPECT_TRUE(std::all_of(seen.begin(), seen.end(), [](int n) { return n == 1; }));
    }
}

// Texels between two ranges; 0: they touch.
int gap(int a0, int a1, int b0, int b1, int length, bool wraps) {
  const int plain = std::max(b0 - a1, a0 - b1);
  return wraps ? std::min(plain, std::min(a0 + length - b1, b0 + length - a1)) : plain;
}

TEST(Lanes, NeverWorkOnTilesThatTouch) {
  for (const SizePx size : kSizes)
    for (const bool wraps : {false, true}) {
      const Lanes lanes(size, wraps);
      for (int step = 0; step < lanes.steps(); ++step)
        for (int a = 0; a < lanes.count(); ++a)
          for (int b = a + 1; b < lanes.count(); ++b) {
            const Tile one = lanes.tile(a, step, true), other = lanes.tile(b, step, true);
            if (one.x1 == 0 || other.x1 == 0) continue;
            EXPECT_GT(gap(one.x0, one.x1, other.x0, other.x1, size.width, wraps), 0);
          }
    }
}

TEST(Lanes, HaveASmallPartOfTheTargetInWork) {
  const Lanes lanes({512, 512}, false);
  EXPECT_EQ(lanes.count(), 4);
  const Tile tile = lanes.tile(0, 0, true);
  EXPECT_LE(lanes.count() * tile.x1 * tile.y1, 512 * 512 / 128);
}

TEST(Lanes, GoBackTheWayTheyCame) {
  const Lanes lanes({512, 512}, false);
  for (int lane = 0; lane < lanes.count(); ++lane) {
    const Tile first = lanes.tile(lane, 0, true), last = lanes.tile(lane, lanes.steps() - 1, false);
    EXPECT_EQ(first.x0, last.x0);
    EXPECT_EQ(first.y0, last.y0);
  }
}

}  // namespace
}  // namespace patina::patch
