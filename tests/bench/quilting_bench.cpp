// SPDX-License-Identifier: GPL-3.0-or-later
// Seconds per placed block, beside the direct sum over all corners in the same run (source 256x256,
// block 64, overlap 16, rank 15: 37,249 corners), and what stands before it: decomposition, file.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <cmath>

#include "processing/decomposition/temporal_svd.h"
#include "processing/image/random.h"
#include "processing/patch/grid_cut.h"
#include "processing/patch/overlap_search.h"
#include "processing/synthesis/quilting/quilting.h"
#include "processing/ttf/ttf_file.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

constexpr int kSource = 256, kBlock = 64, kOverlap = 16, kRank = 15;

// Smooth planes, amplitudes falling as scores of a decomposition do.
Image<float> features(int size, int rank) {
  Image<float> f(size, size, rank);
  tbb::parallel_for(0, size, [&](int y) {
    for (int x = 0; x < size; ++x)
      for (int k = 0; k < rank; ++k) {
        double v = 0;
        for (int wave = 0; wave < 12; ++wave) {
          const std::uint64_t s = hashSeed(1, k, wave);
          v += std::sin(0.3 * gaussian(s) * x + 0.3 * gaussian(s ^ 7) * y + 6.28 * uniform(s));
        }
        f.at(x, y, k) = static_cast<float>(v / (1 + 0.3 * k * k));
      }
  });
  return f;
}

// An L-shaped overlap made of two places of the source, as quilting sees it.
struct Query {
  Image<float> target{kBlock, kBlock, kRank};
  Image<std::uint8_t> known{kBlock, kBlock, 1};
  explicit Query(const Image<float>& f) {
    for (int y = 0; y < kBlock; ++y)
      for (int x = 0; x < kBlock; ++x) {
        known.at(x, y) = x < kOverlap || y < kOverlap;
        for (int k = 0; k < kRank; ++k)
          target.at(x, y, k) = y < kOverlap ? f.at(x + 20, y + 150, k) : f.at(x + 111, y + 37, k);
      }
  }
  patch::Overlap overlap() const { return {target.view(), known.view()}; }
};

void BM_OverlapSearch(benchmark::State& state) {
  const Image<float> f = features(kSource, kRank);
  const Query query(f);
  patch::OverlapSearch search(f.view(), {kBlock, kBlock});
  for (auto _ : state) benchmark::DoNotOptimize(search.candidates(query.overlap(), {0.1, 0, {}}));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_OverlapSearch)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_OverlapSearchDirect(benchmark::State& state) {
  const Image<float> f = features(kSource, kRank);
  const Query query(f);
  const patch::OverlapSearch search(f.view(), {kBlock, kBlock});
  const SizePx corners = search.corners();
  Image<double> cost(corners.width, corners.height, 1);
  for (auto _ : state) {
    tbb::parallel_for(0, corners.height, [&](int y) {
      for (int x = 0; x < corners.width; ++x)
        cost.at(x, y) = search.squaredDistance(query.overlap(), x, y);
    });
    benchmark::DoNotOptimize(cost.texels().data());
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_OverlapSearchDirect)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_MinimumCut(benchmark::State& state) {
  const int size = static_cast<int>(state.range(0)), overlap = size / 4;
  Image<double> difference(size, size, 1, -1);
  Image<patch::Side> side(size, size, 1, patch::Side::kNew);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      if (x < overlap || y < overlap) {
        difference.at(x, y) = 1 + std::sin(0.4 * x) * std::cos(0.3 * y);
        side.at(x, y) = x == 0 || y == 0 ? patch::Side::kOld : patch::Side::kFree;
      }
  for (auto _ : state)
    benchmark::DoNotOptimize(
        patch::minimumCut(std::as_const(difference).view(), std::as_const(side).view()));
}
BENCHMARK(BM_MinimumCut)->Arg(64)->Arg(160)->Unit(benchmark::kMicrosecond);

// A whole quilt of four times the area; items are blocks.
void BM_Quilt(benchmark::State& state) {
  const Image<float> f = features(kSource, kRank);
  quilting::QuiltingOptions options;
  options.size = {2 * kSource, 2 * kSource};
  options.block_px = {kBlock, kBlock};
  options.overlap_px = kOverlap;
  std::int64_t blocks = 0;
  for (auto _ : state) {
    Progress progress;
    blocks += quilting::quilt(f.view(), options, progress).report.blocks;
  }
  state.SetItemsProcessed(blocks);
}
BENCHMARK(BM_Quilt)->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_TemporalSvd(benchmark::State& state) {
  const std::int64_t m = state.range(0), n = state.range(1);
  std::vector<float> matrix(static_cast<std::size_t>(m * n));
  tbb::parallel_for(std::int64_t{0}, m, [&](std::int64_t i) {
    for (std::int64_t j = 0; j < n; ++j)
      matrix[i * n + j] = static_cast<float>(uniform(hashSeed(1, i, j)));
  });
  for (auto _ : state) {
    Progress progress;
    benchmark::DoNotOptimize(decomposition::temporalSvd(m, n, matrix, {.rank = kRank}, progress));
  }
  state.SetItemsProcessed(state.iterations() * m);
}
BENCHMARK(BM_TemporalSvd)->Args({65536, 500})->Unit(benchmark::kMillisecond)->UseRealTime();

void BM_WriteTtf(benchmark::State& state) {
  const int frames = static_cast<int>(state.range(0)), side = static_cast<int>(state.range(1));
  Image<float> frame(side, side, 3);
  for (std::size_t i = 0; i < frame.texels().size(); ++i)
    frame.texels()[i] = static_cast<float>(uniform(hashSeed(1, i)));
  const testing::TempFolder folder;
  for (auto _ : state) {
    ttf::TtfInfo info;
    info.width = info.height = side;
    ttf::TtfWriter writer(folder / "a.h5", info);
    for (int t = 0; t < frames; ++t) writer.add(std::as_const(frame).view(), t, {});
    writer.close();
  }
  state.SetBytesProcessed(state.iterations() * frames * side * side * 6);
}
BENCHMARK(BM_WriteTtf)->Args({120, 450})->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace patina
