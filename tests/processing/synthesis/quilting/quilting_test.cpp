// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/quilting.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <functional>

#include "processing/image/sha256.h"
#include "processing/synthesis/quilting/seam_statistics.h"
#include "tests/processing/synthesis/quilting/textures.h"

namespace patina::quilting {
namespace {

QuiltResult run(const Image<float>& features, const QuiltingOptions& options) {
  Progress progress;
  return quilt(features.view(), options, progress);
}

QuiltingOptions small(SizePx size, std::uint64_t seed = 1) {
  QuiltingOptions o;
  o.size = size;
  o.block_px = {16, 16};
  o.seed = seed;
  return o;
}

void expectSourcesWithin(const QuiltResult& r, SizePx size, SizePx source) {
  ASSERT_EQ(r.quilt.source_xy.size(), size);
  ASSERT_EQ(r.quilt.block.size(), size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const auto from = r.quilt.source_xy.view().texel(x, y);
      ASSERT_TRUE(from[0] >= 0 && from[0] < source.width && from[1] >= 0 && from[1] < source.height)
          << x << "," << y << " comes from " << from[0] << "," << from[1];
      ASSERT_GE(r.quilt.block.at(x, y), 0);
    }
}

TEST(Quilting, ReproducesAPeriodicTextureWithoutAnySeamCost) {
  const Image<float> f = periodicTexture({60, 60}, 8);
  const QuiltResult r = run(f, small({100, 90}));
  EXPECT_EQ(r.report.seam_cost_mean, 0);
  const Image<float> out = applyQuilt(f.view(), r.quilt);
  for (int y = 0; y + 8 < 90; ++y)
    for (int x = 0; x + 8 < 100; ++x)
      for (int c = 0; c < 2; ++c) {
        ASSERT_EQ(out.at(x, y, c), out.at(x + 8, y, c));
        ASSERT_EQ(out.at(x, y, c), out.at(x, y + 8, c));
      }
}

TEST(Quilting, TakesBlocksFromEveryPartAndNothingFromBetween) {
  const Image<float> f = periodicTexture({100, 60}, 8);
  QuiltingOptions o = small({150, 120});
  o.parts = {{0, 0, 48, 60}, {52, 0, 48, 40}};
  const QuiltResult r = run(f, o);
  const auto map = r.quilt.source_xy.view();
  for (int y = 0; y < map.height; ++y)
    for (int x = 0; x < map.width; ++x) {
      const auto from = map.texel(x, y);
      ASSERT_TRUE(from[0] < 48 || (from[0] >= 52 && from[1] < 40)) << from[0] << "," << from[1];
    }
  ASSERT_EQ(r.report.part_shares.size(), 2u);
  EXPECT_NEAR(r.report.part_shares[0] + r.report.part_shares[1], 1, 1e-12);
  EXPECT_GT(r.report.part_shares[0], 0.1);
  EXPECT_GT(r.report.part_shares[1], 0.1);
}

TEST(Quilting, MeasuresBlocksAndPlacesGivenByHandAgainstThePartsTheyLieIn) {
  const Image<float> f = periodicTexture({100, 60}, 8);
  QuiltingOptions o = small({150, 120});
  o.parts = {{0, 0, 48, 60}, {52, 0, 48, 40}};
  EXPECT_EQ(o.blockFor(f.size()), (SizePx{16, 16}));
  o.block_px = {16, 44};
  EXPECT_THROW(o.check(f.size()), ProcessingError);
  o.block_px = {16, 16};
  o.first = PointPx{40, 0};
  EXPECT_THROW(o.check(f.size()), ProcessingError);
  o.first = PointPx{32, 0};
  o.low_frequency = LowFrequencyUse::kDrop;
  EXPECT_THROW(o.check(f.size()), ProcessingError);
}

// Blocks of 16 laid edge to edge, drawn from anywhere.
Quilt patchwork(SizePx size, SizePx source) {
  Quilt q{Image<std::int32_t>(size.width, size.height, 2),
          Image<std::int32_t>(size.width, size.height, 1)};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      q.source_xy.at(x, y, 0) =
          x % 16 + static_cast<int>(uniformBelow(hashSeed(1, x / 16, y / 16), source.width - 16));
      q.source_xy.at(x, y, 1) =
          y % 16 + static_cast<int>(uniformBelow(hashSeed(2, x / 16, y / 16), source.height - 16));
    }
  return q;
}

TEST(Quilting, HidesSeamsThatAPatchworkShows) {
  const Image<float> f = waveTexture({120, 120}, 3);
  const QuiltResult quilted = run(f, small({160, 160}));
  const Quilt patches = patchwork({160, 160}, {120, 120});
  EXPECT_GT(quilted.report.seam_ratio, 0);
  EXPECT_LT(quilted.report.seam_ratio,
            0.4 * seamRatio(applyQuilt(f.view(), patches).view(), patches));
  EXPECT_EQ(quilted.report.rank, 3);
}

// Stripes of calm between stripes of noise, both as wide as an overlap: cuts by differences alone
// stay in the calm.
TEST(Quilting, LeadsSeamsNeitherThroughTheCalmOnlyNorThroughTheLiveliest) {
  Image<float> f(120, 120, 1);
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 120; ++x)
      f.at(x, y) = static_cast<float>(((x + y) / 6 % 2 ? 1.0 : 0.2) * gaussian(hashSeed(8, x, y)));
  EXPECT_NEAR(seamSelection(f.view(), run(f, small({160, 160})).quilt), 0.92, 0.05);
}

TEST(Quilting, CopiesOnlyTexelsThatExistForAnySize) {
  const Image<float> f = waveTexture({40, 50}, 2);
  for (SizePx size : {SizePx{1, 1}, SizePx{7, 5}, SizePx{16, 16}, SizePx{17, 16}, SizePx{83, 41},
                      SizePx{1, 100}, SizePx{100, 1}}) {
    const QuiltResult r = run(f, small(size));
    expectSourcesWithin(r, size, {40, 50});
  }
}

TEST(Quilting, TakesTallBlocksAndOverlapsOfAnyWidth) {
  const Image<float> f = waveTexture({50, 120}, 2);
  for (SizePx block : {SizePx{12, 60}, SizePx{50, 12}, SizePx{4, 4}, SizePx{50, 120}})
    for (int overlap : {0, 1, std::min(block.width, block.height) / 2}) {
      QuiltingOptions o = small({60, 70});
      o.block_px = block;
      o.overlap_px = overlap;
      expectSourcesWithin(run(f, o), o.size, {50, 120});
    }
}

TEST(Quilting, CopiesWholePiecesOfTheSource) {
  const QuiltResult r = run(waveTexture({70, 70}, 2), small({120, 120}));
  const auto& map = r.quilt.source_xy;
  std::int64_t joined = 0, pairs = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x + 1 < 120; ++x, ++pairs) {
      const bool follows =
          map.at(x + 1, y, 0) == map.at(x, y, 0) + 1 && map.at(x + 1, y, 1) == map.at(x, y, 1);
      joined += follows;
      ASSERT_TRUE(follows || r.quilt.block.at(x, y) != r.quilt.block.at(x + 1, y));
    }
  EXPECT_GT(joined, 0.85 * pairs);
}

TEST(Quilting, CopiesEveryFrameThroughTheSameMap) {
  const QuiltResult r = run(waveTexture({40, 40}, 2), small({60, 50}));
  for (int t = 0; t < 3; ++t) {
    Image<std::uint16_t> frame(40, 40, 3);
    for (std::size_t i = 0; i < frame.texels().size(); ++i)
      frame.texels()[i] = static_cast<std::uint16_t>(hashSeed(t, i));
    const Image<std::uint16_t> out = applyQuilt(std::as_const(frame).view(), r.quilt);
    for (int y = 0; y < 50; ++y)
      for (int x = 0; x < 60; ++x)
        for (int c = 0; c < 3; ++c)
          ASSERT_EQ(out.at(x, y, c),
                    frame.at(r.quilt.source_xy.at(x, y, 0), r.quilt.source_xy.at(x, y, 1), c));
  }
}

TEST(Quilting, GivesAnotherResultForAnotherSeedAndTheSameForTheSame) {
  const Image<float> f = waveTexture({60, 60}, 2);
  const auto map = [&](std::uint64_t seed) {
    return run(f, small({80, 80}, seed)).quilt.source_xy;
  };
  EXPECT_EQ(map(1).texels(), map(1).texels());
  EXPECT_NE(map(1).texels(), map(2).texels());
}

TEST(Quilting, GivesTheSameBytesForAnyNumberOfThreads) {
  const Image<float> f = waveTexture({80, 80}, 4);
  const auto with = [&](int threads) {
    tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 4);
    tbb::task_arena arena(threads);
    return arena.execute([&] { return run(f, small({150, 150})); });
  };
  const QuiltResult one = with(1), four = with(4);
  EXPECT_EQ(one.quilt.source_xy.texels(), four.quilt.source_xy.texels());
  EXPECT_EQ(one.report.seam_ratio, four.report.seam_ratio);
}

TEST(Quilting, KeepsTheMapItOnceGave) {
  // Whole numbers: no rounding of this machine's sine in it.
  Image<float> f(48, 48, 2);
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 48; ++x) {
      f.at(x, y, 0) = static_cast<float>((x / 4 + y / 6) % 5);
      f.at(x, y, 1) = static_cast<float>(hashSeed(1, x / 2, y / 2) % 3);
    }
  const QuiltResult r = run(f, small({64, 64}));
  const auto& map = r.quilt.source_xy.texels();
  EXPECT_EQ(sha256(std::as_bytes(std::span(map))).hex().substr(0, 16), "b622295c1b795254");
}

TEST(Quilting, WrapsAroundWithoutAVisibleSeamWhereAsked) {
  const Image<float> f = periodicTexture({60, 60}, 8);
  QuiltingOptions o = small({96, 80});
  o.tile = true;
  const QuiltResult r = run(f, o);
  EXPECT_EQ(r.report.seam_cost_mean, 0);
  const Image<float> out = applyQuilt(f.view(), r.quilt);
  for (int y = 0; y < 80; ++y) EXPECT_EQ(out.at(95, y), out.at(95 - 88, y));
  for (int y = 0; y < 80; ++y) EXPECT_EQ(out.at(0, y), out.at(88, y));
  expectSourcesWithin(r, o.size, {60, 60});
}

TEST(Quilting, ShowsNoRegionTwiceSideBySideWhereTheSourceIsLargeEnough) {
  const QuiltResult r = run(waveTexture({160, 160}, 3), small({160, 160}));
  const auto& map = r.quilt.source_xy;
  // The same source texel at two places closer than one and a half blocks: only where few are left.
  std::int64_t echoes = 0;
  for (int y = 0; y < 160; y += 4)
    for (int x = 0; x < 160; x += 4)
      for (int v = std::max(0, y - 24); v <= y; v += 1)
        for (int u = std::max(0, x - 24); u < std::min(160, x + 24); ++u)
          echoes += (u != x || v != y) && map.at(u, v, 0) == map.at(x, y, 0) &&
                    map.at(u, v, 1) == map.at(x, y, 1);
  EXPECT_LT(echoes, 40 * 40 / 32);
}

TEST(Quilting, RefusesImpossibleOptionsWithFieldValueAndRange) {
  const Image<float> f = waveTexture({40, 30}, 2);
  const auto refused = [&](const std::function<void(QuiltingOptions&)>& spoil) {
    QuiltingOptions o = small({60, 60});
    spoil(o);
    try {
      run(f, o);
      return std::string("taken");
    } catch (const ProcessingError& e) {
      EXPECT_EQ(e.exit(), Exit::kUsage);
      return std::string(e.what());
    }
  };
  EXPECT_EQ(refused([](auto& o) {
              o.block_px = {41, 16};
            }),
            "quilting: block_px is 41x16; allowed: 2x2 to the source's 40x30");
  EXPECT_EQ(refused([](auto& o) { o.overlap_px = 9; }),
            "quilting: overlap_px is 9; allowed: 0 (two fifths of the block) to 8, half the block");
  EXPECT_EQ(refused([](auto& o) {
              o.size = {0, 5};
            }),
            "quilting: size is 0x5; allowed: 1x1 to 65535x65535");
  EXPECT_NE(refused([](auto& o) { o.tolerance = -0.1; }), "taken");
  EXPECT_NE(refused([](auto& o) { o.tolerance = std::nan(""); }), "taken");
  EXPECT_NE(refused([](auto& o) { o.rank_error = 0; }), "taken");
  EXPECT_NE(refused([](auto& o) { o.svd_rank = 0; }), "taken");
  EXPECT_NE(refused([](auto& o) { o.verbatim = 1.1; }), "taken");
  EXPECT_NE(refused([](auto& o) { o.repetition_penalty = -1; }), "taken");
  EXPECT_NE(refused([](auto& o) { o.tile = true, o.size = {10, 60}; }), "taken");
}

TEST(Quilting, TakesASixthOfTheSourceForABlockUnlessToldOtherwise) {
  const QuiltingOptions o;
  EXPECT_EQ(o.blockFor({448, 600}), (SizePx{74, 74}));
  EXPECT_EQ(o.blockFor({60, 60}), (SizePx{24, 24}));
  EXPECT_EQ(o.blockFor({10, 60}), (SizePx{10, 24}));
  EXPECT_EQ(o.blockFor({4000, 4000}), (SizePx{160, 160}));
  EXPECT_EQ(o.overlapFor({64, 320}), (SizePx{25, 128}));
  QuiltingOptions plain;
  plain.size = {50, 60};
  const QuiltResult r = run(waveTexture({40, 30}, 2), plain);
  EXPECT_EQ(r.quilt.block.size(), (SizePx{50, 60}));
}

TEST(Quilting, StopsWhenAsked) {
  Progress progress;
  progress.askToStop();
  const Image<float> f = waveTexture({40, 30}, 2);
  EXPECT_THROW(quilt(f.view(), small({60, 60}), progress), Stopped);
}

}  // namespace
}  // namespace patina::quilting
