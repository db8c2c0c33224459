// SPDX-License-Identifier: GPL-3.0-or-later
// Quilting's two inner costs on the histories of three specimens (256x256 texels, 500 frames)
// beside what others would do in their place: the best of 37,249 corners for a block of 64 with an
// overlap of 16, and a decomposition to rank 15. quilting_peers.py runs these and numpy, and prints
// ratios.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <map>
#include <opencv2/imgproc.hpp>

#include "processing/decomposition/temporal_svd.h"
#include "processing/image/random.h"
#include "processing/patch/overlap_search.h"
#include "tests/bench/specimen_series.h"

namespace patina {
namespace {

constexpr int kSource = 256, kFrames = 500, kBlock = 64, kOverlap = 16, kRank = 15, kQueries = 64;
constexpr std::int64_t kTexels = std::int64_t{kSource} * kSource;
constexpr std::array kSpecimens{"grass_growth", "snow_accumulation", "steel_rusting"};

struct Specimen {
  std::vector<float> series;  // [frame][y][x]
  Image<float> features{kSource, kSource, kRank};
};

const Specimen& specimen(std::int64_t index) {
  static std::map<std::int64_t, Specimen> made;
  if (const auto it = made.find(index); it != made.end()) return it->second;
  Specimen& s = made[index];
  s.series = bench::specimenSeries(kSpecimens[index], {kSource, kSource}, kFrames);
  Progress progress;
  s.features.texels() = decomposition::temporalSvd(kTexels, kFrames, s.series,
                                                   {.rank = kRank, .centre = true}, progress)
                            .scores;
  // For a peer in another language: as it lies here.
  if (const char* folder = std::getenv("PATINA_BENCH_MATRICES"))
    std::ofstream(std::string(folder) + "/" + kSpecimens[index] + ".f32", std::ios::binary)
        .write(reinterpret_cast<const char*>(s.series.data()),
               static_cast<std::streamsize>(s.series.size() * sizeof(float)));
  return s;
}

// What lies under a block: above it one place of the source, on its left another.
struct Query {
  SizePx above{}, left{};
  explicit Query(int number) {
    const auto draw = [&](int key) {
      return static_cast<int>(uniformBelow(hashSeed(1, number, key), kSource - kBlock + 1));
    };
    above = {draw(1), draw(2)};
    left = {draw(3), draw(4)};
  }
  bool isKnown(int x, int y) const { return x < kOverlap || y < kOverlap; }
  SizePx sourceOf(int x, int y) const {
    const SizePx& from = y < kOverlap ? above : left;
    return {from.width + x, from.height + y};
  }
};

struct Target {
  Image<float> texels{kBlock, kBlock, kRank};
  Image<std::uint8_t> known{kBlock, kBlock, 1};
  Target(const Image<float>& f, const Query& query) {
    for (int y = 0; y < kBlock; ++y)
      for (int x = 0; x < kBlock; ++x) {
        known.at(x, y) = query.isKnown(x, y);
        const SizePx from = query.sourceOf(x, y);
        std::copy_n(&f.at(from.width, from.height), kRank, &texels.at(x, y));
      }
  }
  patch::Overlap overlap() const { return {texels.view(), known.view()}; }
};

std::vector<Target> targetsOf(const Image<float>& features) {
  std::vector<Target> targets;
  for (int i = 0; i < kQueries; ++i) targets.emplace_back(features, Query(i));
  return targets;
}

void BM_Placement(benchmark::State& state) {
  const Image<float>& f = specimen(state.range(0)).features;
  const std::vector<Target> targets = targetsOf(f);
  patch::OverlapSearch search(f.view(), {kBlock, kBlock});
  int i = 0;
  for (auto _ : state)
    benchmark::DoNotOptimize(search.candidates(targets[i++ % kQueries].overlap(), {0, 0, {}}));
  state.SetLabel(kSpecimens[state.range(0)]);
}
BENCHMARK(BM_Placement)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

// The overlap as two strips, the upper one and what is left of the left one, channel by channel.
void BM_PlacementByMatchTemplate(benchmark::State& state) {
  const Image<float>& f = specimen(state.range(0)).features;
  const std::vector<Target> targets = targetsOf(f);
  std::vector<cv::Mat> planes;
  for (int k = 0; k < kRank; ++k) {
    planes.emplace_back(kSource, kSource, CV_32F);
    for (int i = 0; i < kTexels; ++i)
      planes.back().at<float>(i / kSource, i % kSource) =
          f.texels()[std::size_t{1} * i * kRank + k];
  }
  constexpr int kCorners = kSource - kBlock + 1;
  int query = 0;
  for (auto _ : state) {
    const Target& target = targets[query++ % kQueries];
    cv::Mat sum(kCorners, kCorners, CV_32F, cv::Scalar(0)), one;
    for (int k = 0; k < kRank; ++k) {
      cv::Mat strip(kBlock, kBlock, CV_32F);
      for (int i = 0; i < kBlock * kBlock; ++i)
        strip.at<float>(i / kBlock, i % kBlock) = target.texels.at(i % kBlock, i / kBlock, k);
      const cv::Rect above(0, 0, kBlock, kOverlap), left(0, kOverlap, kOverlap, kBlock - kOverlap);
      for (const cv::Rect& part : {above, left}) {
        const cv::Rect searched(part.x, part.y, kCorners - 1 + part.width,
                                kCorners - 1 + part.height);
        cv::matchTemplate(planes[k](searched), strip(part), one, cv::TM_SQDIFF);
        sum += one;
      }
    }
    cv::Point best;
    cv::minMaxLoc(sum, nullptr, nullptr, &best);
    benchmark::DoNotOptimize(best);
  }
  state.SetLabel(kSpecimens[state.range(0)]);
}
BENCHMARK(BM_PlacementByMatchTemplate)
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

// Equation 3 as it stands, over all 500 frames: one corner in `kShare`, so the time is a share too.
void BM_PlacementBySequencesOfOneCornerIn64(benchmark::State& state) {
  constexpr int kShare = 64, kCorners = kSource - kBlock + 1;
  const std::vector<float>& series = specimen(state.range(0)).series;
  std::vector<float> histories(series.size());  // [y][x][frame]
  tbb::parallel_for(std::int64_t{0}, kTexels, [&](std::int64_t i) {
    for (int t = 0; t < kFrames; ++t) histories[i * kFrames + t] = series[t * kTexels + i];
  });
  const auto history = [&](int x, int y) {
    return histories.data() + (std::int64_t{y} * kSource + x) * kFrames;
  };
  int number = 0;
  std::vector<float> cost(kCorners * kCorners / kShare);
  for (auto _ : state) {
    const Query query(number++ % kQueries);
    tbb::parallel_for(std::size_t{0}, cost.size(), [&](std::size_t i) {
      const int corner = static_cast<int>(i) * kShare, cx = corner % kCorners,
                cy = corner / kCorners;
      float sum = 0;
      for (int y = 0; y < kBlock; ++y)
        for (int x = 0; x < kBlock; ++x) {
          if (!query.isKnown(x, y)) continue;
          const SizePx from = query.sourceOf(x, y);
          const float *a = history(cx + x, cy + y), *b = history(from.width, from.height);
          float lanes[8] = {};
          for (int t = 0; t + 8 <= kFrames; t += 8)
            for (int lane = 0; lane < 8; ++lane)
              lanes[lane] += (a[t + lane] - b[t + lane]) * (a[t + lane] - b[t + lane]);
          for (float lane : lanes) sum += lane;
        }
      cost[i] = sum;
    });
    benchmark::DoNotOptimize(cost.data());
  }
  state.SetLabel(kSpecimens[state.range(0)]);
}
BENCHMARK(BM_PlacementBySequencesOfOneCornerIn64)
    ->DenseRange(0, 2)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void BM_SpecimenSvd(benchmark::State& state) {
  const std::vector<float>& series = specimen(state.range(0)).series;
  decomposition::TemporalSvd svd;
  for (auto _ : state) {
    Progress progress;
    svd = decomposition::temporalSvd(kTexels, kFrames, series, {.rank = kRank}, progress);
  }
  state.SetLabel(kSpecimens[state.range(0)]);
  for (int k = 0; k < kRank; ++k) state.counters["s" + std::to_string(k)] = svd.singular_values[k];
}
BENCHMARK(BM_SpecimenSvd)->DenseRange(0, 2)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
}  // namespace patina
