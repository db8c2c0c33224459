// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "processing/image/random.h"

namespace patina::texture_optimization {
namespace {

constexpr int kSource = 32, kBlock = 8;
constexpr SizePx kTarget{64, 64};

// Soft blobs, none like another.
Image<std::int16_t> blobs() {
  Image<std::int16_t> out(kSource, kSource, 8);
  for (int k = 0; k < 80; ++k) {
    const auto draw = [&](int n) {
      return uniform(hashSeed(static_cast<std::uint64_t>(k), static_cast<std::uint64_t>(n)));
    };
    for (int y = 0; y < kSource; ++y)
      for (int x = 0; x < kSource; ++x) {
        const double away = std::hypot(x - kSource * draw(0), y - kSource * draw(1));
        for (int c = 0; c < 3; ++c)
          out.at(x, y, c) = static_cast<std::int16_t>(
              out.at(x, y, c) + 900 * (draw(2 + c) - 0.5) * std::exp(-away * away / 40));
      }
  }
  return out;
}

// Places that go on in one another.
Image<std::int16_t> waves() {
  Image<std::int16_t> out(kSource, kSource, 8);
  for (int y = 0; y < kSource; ++y)
    for (int x = 0; x < kSource; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<std::int16_t>(
            700 * (std::sin(0.7 * x + c) + std::sin(0.53 * y - 0.3 * x + 2 * c)));
  return out;
}

std::vector<std::int32_t> laid(const LayoutLimits& limits, std::uint64_t seed = 1,
                               SizePx target = kTarget) {
  Progress progress;
  return laidOut(blobs().view(), target, limits, seed, progress);
}

std::size_t indexOf(int x, int y, int width = kTarget.width) {
  return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
         static_cast<std::size_t>(x);
}

// How far away each target texel's own source texel is shown the next time, over the source's
// side, sorted; of those that are shown again.
std::vector<double> nextCopies(const std::vector<std::int32_t>& shown, bool wraps) {
  std::vector<double> out;
  for (int y = 0; y < kTarget.height; ++y)
    for (int x = 0; x < kTarget.width; ++x) {
      double least = std::numeric_limits<double>::max();
      for (int v = 0; v < kTarget.height; ++v)
        for (int u = 0; u < kTarget.width; ++u) {
          if (shown[indexOf(u, v)] != shown[indexOf(x, y)] || (u == x && v == y)) continue;
          int dx = std::abs(u - x), dy = std::abs(v - y);
          if (wraps) {
            dx = std::min(dx, kTarget.width - dx);
            dy = std::min(dy, kTarget.height - dy);
          }
          least = std::min(least, std::hypot(dx, dy) / kSource);
        }
      if (least < 1e9) out.push_back(least);
    }
  std::sort(out.begin(), out.end());
  return out;
}

TEST(Layout, ShowsNoPlaceAgainNearby) {
  for (const bool wraps : {false, true}) {
    const std::vector<double> apart = nextCopies(laid({.wraps = wraps}), wraps);
    ASSERT_GT(apart.size(), 2000u);
    EXPECT_GT(apart[apart.size() / 2], 0.75) << wraps;
    EXPECT_GT(apart[apart.size() / 20], 0.5) << wraps;
  }
}

// Mean squared difference from texel to texel where blocks meet, and of any two that are shown.
TEST(Layout, JoinsItsBlocks) {
  const Image<std::int16_t> source = waves();
  Progress progress;
  const std::vector<std::int32_t> shown = laidOut(source.view(), kTarget, {}, 1, progress);
  const auto difference = [&](std::size_t a, std::size_t b) {
    double sum = 0;
    for (std::size_t c = 0; c < 3; ++c)
      sum += std::pow(source.texels()[8 * static_cast<std::size_t>(shown[a]) + c] -
                          source.texels()[8 * static_cast<std::size_t>(shown[b]) + c],
                      2);
    return sum;
  };
  double at_joins = 0, of_any = 0, joins = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) {
    of_any += difference(i, uniformBelow(hashSeed(i), shown.size()));
    if (i % static_cast<std::size_t>(kTarget.width) == 0 || i % kBlock != 0) continue;
    at_joins += difference(i - 1, i);
    ++joins;
  }
  EXPECT_LT(at_joins / joins, 0.65 * of_any / static_cast<double>(shown.size()));
}

// Two samples side by side would join well and repeat nothing nearby.
TEST(Layout, DoesNotLayWholeSamplesSideBySide) {
  const std::vector<std::int32_t> shown = laid({});
  std::vector<int> of_offset(4 * kTarget.width * kTarget.height);
  for (int y = 0; y < kTarget.height; ++y)
    for (int x = 0; x < kTarget.width; ++x) {
      const std::int32_t texel = shown[indexOf(x, y)];
      const int right = texel % kSource - x + kTarget.width,
                below = texel / kSource - y + kTarget.height;
      const int offset = below * 2 * kTarget.width + right;
      ++of_offset[static_cast<std::size_t>(offset)];
    }
  EXPECT_LE(*std::max_element(of_offset.begin(), of_offset.end()), 6 * kBlock * kBlock);
}

TEST(Layout, ShowsNothingThatIsNotUsable) {
  std::vector<std::uint8_t> usable(kSource * kSource, 1);
  for (int y = 12; y < 18; ++y)
    for (int x = 9; x < 30; ++x) usable[indexOf(x, y, kSource)] = 0;
  for (const std::int32_t texel : laid({.usable = usable}))
    ASSERT_NE(usable[static_cast<std::size_t>(texel)], 0);
  for (int y = 0; y < kSource; y += kBlock - 1)
    for (int x = 0; x < kSource; x += kBlock - 1) usable[indexOf(x, y, kSource)] = 0;
  EXPECT_TRUE(laid({.usable = usable}).empty());
}

// One of 3x3 texels, in a target that even use would show 16 of: as many as lie a side apart.
TEST(Layout, ShowsALandmarkAsOftenAsItsCopiesLieApart) {
  constexpr SizePx kLarge{4 * kSource, 4 * kSource};
  Landmarks landmarks{.size = {kSource, kSource}, .count = 1};
  landmarks.of.assign(kSource * kSource, -1);
  for (int y = 14; y < 17; ++y)
    for (int x = 10; x < 13; ++x) landmarks.of[indexOf(x, y, kSource)] = 0;
  const std::int32_t middle = 15 * kSource + 11;
  std::size_t copies = 0;
  for (const std::uint64_t seed : {1u, 2u, 3u, 4u}) {
    const std::vector<std::int32_t> shown = laid({.landmarks = &landmarks}, seed, kLarge);
    std::vector<std::pair<int, int>> at;
    for (int y = 0; y < kLarge.height; ++y)
      for (int x = 0; x < kLarge.width; ++x)
        if (shown[indexOf(x, y, kLarge.width)] == middle) at.emplace_back(x, y);
    copies += at.size();
    for (std::size_t i = 0; i < at.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        EXPECT_GE(std::hypot(at[i].first - at[k].first, at[i].second - at[k].second),
                  0.98 * kSource)
            << seed;
  }
  EXPECT_GE(copies, 4 * 14u);  // 12 or 13 each where none is owed
}

TEST(Layout, LeavesWhatIsKept) {
  std::vector<std::int32_t> kept(indexOf(0, kTarget.height), -1);
  for (int y = 20; y < 40; ++y)
    for (int x = 20; x < 40; ++x)
      kept[indexOf(x, y)] = static_cast<std::int32_t>(indexOf(x - 12, y - 16, kSource));
  const std::vector<std::int32_t> shown = laid({.kept = kept});
  for (std::size_t i = 0; i < kept.size(); ++i)
    ASSERT_TRUE(kept[i] < 0 ? shown[i] >= 0 : shown[i] == kept[i]);
}

TEST(Layout, FillsTargetsOfAnySize) {
  for (const SizePx target : {SizePx{5, 5}, {33, 61}, {150, 9}})
    for (const bool wraps : {false, true}) {
      const std::vector<std::int32_t> shown = laid({.wraps = wraps}, 1, target);
      ASSERT_EQ(shown.size(), indexOf(0, target.height, target.width));
      for (const std::int32_t texel : shown) ASSERT_TRUE(texel >= 0 && texel < kSource * kSource);
    }
}

TEST(Layout, IsAnotherForAnotherSeed) {
  EXPECT_EQ(laid({}, 1), laid({}, 1));
  EXPECT_NE(laid({}, 1), laid({}, 2));
}

}  // namespace
}  // namespace patina::texture_optimization
