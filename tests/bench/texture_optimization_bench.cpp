// SPDX-License-Identifier: GPL-3.0-or-later
// Texture optimisation by its own search and by PatchMatch, of reflectance sets and of pictures:
// time, and the energy by its own count (weights 1,1,0; uniformity 0.075; patch 5). The sample is
// a corner of the published set in $PATINA_TEST_DATA.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <optional>

#include "processing/stbrdf/stbrdf_file.h"
#include "processing/synthesis/texture_optimization/enlarge.h"
#include "processing/synthesis/texture_optimization/ttf_optimize.h"

namespace patina {
namespace {

namespace optimization = texture_optimization;

constexpr int kSample = 256, kResult = 512;

// The set, or its upper left corner.
std::optional<stbrdf::StbrdfSet> sampleSet(int side = kSample) {
  const char* data = std::getenv("PATINA_TEST_DATA");
  if (data == nullptr) return std::nullopt;
  Progress progress;
  stbrdf::StbrdfSet set =
      stbrdf::readStbrdfSet(std::filesystem::path(data) / "snowyground_stbrdf", progress);
  std::erase_if(set.maps, [](const stbrdf::TimeMap& map) {
    return map.name != "Diffuse" && map.name != "Specular" && map.name != "Roughness";
  });
  for (stbrdf::TimeMap& map : set.maps)
    for (Image<float>& c : map.coefficients)
      c = copyOf<float>(std::as_const(c).view().crop({0, 0, side, side}));
  return set;
}

// Degree 5, of the same polynomials and a little of every power: as many numbers as a set of that
// degree has.
void raiseTo5(stbrdf::StbrdfSet& set) {
  for (stbrdf::TimeMap& map : set.maps)
    for (const std::size_t from : {1u, 2u}) {
      Image<float> more = map.coefficients[from];
      for (float& v : more.texels()) v *= 0.05f;
      map.coefficients.push_back(std::move(more));
    }
  set.degree = 5;
}

optimization::EnlargeOptions optionsFor(const benchmark::State& state) {
  optimization::EnlargeOptions options;
  options.optimize.size = {kResult, kResult};
  options.optimize.field.search =
      state.range(0) == 0 ? patch::SearchKind::kCoherent : patch::SearchKind::kPatchMatch;
  if (state.range(0) == 1) options.optimize.passes = 4;
  return options;
}

void count(benchmark::State& state, const optimization::OptimizedField& field) {
  state.counters["energy"] = field.energy.patch + 0.075 * field.energy.occupancy;
  state.counters["texels/s"] = benchmark::Counter(static_cast<double>(field.centres.size()),
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

// The sample's upper left corner, enlarged.
void enlargeCorner(benchmark::State& state, int side, std::int64_t degree,
                   const optimization::EnlargeOptions& options) {
  std::optional<stbrdf::StbrdfSet> set = sampleSet(side);
  if (!set) {
    state.SkipWithError("needs PATINA_TEST_DATA");
    return;
  }
  if (degree == 5) raiseTo5(*set);
  optimization::OptimizedField field;
  for (auto _ : state) {
    Progress progress;
    field = optimization::enlarge(*set, options, {}, progress).field;
  }
  count(state, field);
}

// search (0: coherent, 1: PatchMatch), degree, effort (0: full, 1: quick)
void BM_Enlarge(benchmark::State& state) {
  optimization::EnlargeOptions options = optionsFor(state);
  if (state.range(2) == 1) options.optimize.effort = optimization::Effort::kQuick;
  enlargeCorner(state, kSample, state.range(1), options);
}
BENCHMARK(BM_Enlarge)
    ->ArgsProduct({{0, 1}, {3, 5}, {0}})
    ->Args({0, 3, 1})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// The whole set, 512x512 to 2048x2048. degree
void BM_EnlargeWhole(benchmark::State& state) {
  optimization::EnlargeOptions options;
  options.optimize.size = {2048, 2048};
  enlargeCorner(state, 512, state.range(0), options);
}
BENCHMARK(BM_EnlargeWhole)
    ->Arg(3)
    ->Arg(5)
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

// 8-bit RGB. search, effort (0: full, 1: quick)
void BM_EnlargePicture(benchmark::State& state) {
  const std::optional<stbrdf::StbrdfSet> set = sampleSet();
  if (!set) {
    state.SkipWithError("needs PATINA_TEST_DATA");
    return;
  }
  Image<float> picture = set->find("Diffuse")->coefficients[0];
  for (float& v : picture.texels()) v = std::round(std::clamp(v, 0.0f, 1.0f) * 255) / 255;
  optimization::OptimizeOptions options = optionsFor(state).optimize;
  options.effort = state.range(1) == 0 ? optimization::Effort::kFull : optimization::Effort::kQuick;
  optimization::OptimizedField field;
  for (auto _ : state) {
    Progress progress;
    field = optimization::enlargePicture(picture.view(), options, {}, progress).field;
  }
  count(state, field);
}
BENCHMARK(BM_EnlargePicture)
    ->Args({0, 1})
    ->Args({0, 0})
    ->Args({1, 0})
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

}  // namespace
}  // namespace patina
