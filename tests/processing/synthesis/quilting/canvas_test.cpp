// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/canvas.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {
namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();

constexpr SizePx kBlock{10, 10};

TEST(Canvas, KnowsNothingAtFirstAndThenWhatWasPasted) {
  const Image<float> f = waveTexture({40, 40}, 2);
  Canvas canvas(f.view(), {30, 20}, kBlock, false);
  canvas.look(0, 0, 0);
  EXPECT_EQ(canvas.knownTexels(), 0);
  canvas.paste(5, 7);
  const patch::Overlap overlap = canvas.look(6, 0, 1);
  EXPECT_EQ(canvas.knownTexels(), 4 * 10);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 10; ++x) {
      EXPECT_EQ(overlap.known.at(x, y), x < 4);
      if (x >= 4) continue;
      EXPECT_EQ(overlap.target.at(x, y, 1), f.at(5 + 6 + x, 7 + y, 1));
    }
}

TEST(Canvas, KeepsTexelsBesideOldOnesAndTakesThoseWhereNothingIs) {
  const Image<float> f = waveTexture({40, 40}, 2);
  Canvas canvas(f.view(), {16, 10}, kBlock, false);
  canvas.look(0, 0, 0);
  canvas.paste(0, 0);
  canvas.look(6, 0, 1);
  canvas.paste(20, 20);
  const Quilt quilt = canvas.cropped({16, 10});
  for (int y = 0; y < 10; ++y) {
    EXPECT_EQ(quilt.block.at(6, y), 0);   // the overlap's first column borders the old block
    EXPECT_EQ(quilt.block.at(10, y), 1);  // beyond the overlap
    EXPECT_EQ(quilt.source_xy.at(12, y, 0), 20 + 6);
    EXPECT_EQ(quilt.source_xy.at(12, y, 1), 20 + y);
  }
}

TEST(Canvas, FindsNoSeamWhereACopyGoesOn) {
  const Image<float> f = waveTexture({40, 40}, 3);
  Canvas canvas(f.view(), {16, 10}, kBlock, false);
  canvas.look(0, 0, 0);
  canvas.paste(3, 4);
  canvas.look(6, 0, 1);
  EXPECT_EQ(canvas.seamEstimate(9, 4, {4, 4}, kNoLimit), 0);
  EXPECT_GT(canvas.seamEstimate(10, 4, {4, 4}, kNoLimit), 0);
  EXPECT_EQ(canvas.paste(9, 4).cost, 0);
}

// Of six columns two are calm; of an overlap's four, the first two.
TEST(Canvas, CutsThroughLivelyPlacesWhereTheyCountForMore) {
  Image<float> f(40, 40, 1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x)
      f.at(x, y) = static_cast<float>((x % 6 < 2 ? 0.1 : 1.0) * gaussian(hashSeed(4, x, y)));
  const auto oldTexels = [&](double liveliness) {
    Canvas canvas(f.view(), {16, 10}, kBlock, false);
    canvas.setLiveliness(liveliness);
    canvas.look(0, 0, 0);
    canvas.paste(0, 0);
    canvas.look(6, 0, 1);
    canvas.paste(12, 20);
    const Quilt quilt = canvas.cropped({16, 10});
    return std::count(quilt.block.texels().begin(), quilt.block.texels().end(), 0);
  };
  EXPECT_LE(oldTexels(0), 7 * 10 + 2);
  EXPECT_GE(oldTexels(1.5), 8 * 10);
}

// Steps across edges to the right count, those down do not: the cut runs along rows only.
TEST(Canvas, JudgesEdgesOfEachDirectionByTheMetric) {
  const Image<float> f = waveTexture({40, 40}, 2);
  SeamMetric metric;
  metric.channels = 2;
  metric.matrix = {std::vector<float>{1, 0, 0, 1}, std::vector<float>{0, 0, 0, 0}};
  Canvas canvas(f.view(), {10, 16}, kBlock, false, nullptr, &metric);
  canvas.look(0, 0, 0);
  canvas.paste(3, 4);
  canvas.look(0, 6, 1);
  EXPECT_EQ(canvas.seamEstimate(20, 20, {4, 4}, kNoLimit), 0);
  EXPECT_EQ(canvas.paste(20, 20).cost, 0);
}

TEST(Canvas, MeetsItselfWhereItWraps) {
  const Image<float> f = waveTexture({40, 40}, 2);
  Canvas canvas(f.view(), {16, 12}, kBlock, true);
  canvas.look(0, 0, 0);
  canvas.paste(1, 2);
  const patch::Overlap overlap = canvas.look(12, 0, 1);  // columns 16, 17, ... are 0, 1, ...
  for (int x = 0; x < 10; ++x) EXPECT_EQ(overlap.known.at(x, 5), x >= 4);
  EXPECT_EQ(overlap.target.at(4, 5, 0), f.at(1, 7, 0));
}

}  // namespace
}  // namespace patina::quilting
