// SPDX-License-Identifier: GPL-3.0-or-later
// The fit of 512x512 texels under 24 lights (GGX, normals). A general solver on the same problem,
// texel by texel, is in ceres_peer.cpp: Debian's Ceres brings ATLAS along.
#include <benchmark/benchmark.h>

#include <map>

#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf {
namespace {

constexpr int kLights = 24;

const LitSurface& surfaceOf(int size) {
  static std::map<int, LitSurface> kept;
  const auto at = kept.find(size);
  if (at != kept.end()) return at->second;
  return kept.emplace(size, lit(rollingMaps(size, size, {0.15f, 0.3f}), Model::kGgx, dome(kLights)))
      .first->second;
}

void BM_ManyLights(benchmark::State& state) {
  const auto size = static_cast<int>(state.range(0));
  const LitSurface& surface = surfaceOf(size);
  MultiLightOptions options = calmOptions();
  options.neighbours = state.range(1) != 0;
  double residual = 0;
  for (auto _ : state) {
    Progress progress;
    residual = fitManyLights(surface.samples, options, {}, progress).report.residual_rms;
  }
  state.counters["residual_rms"] = residual;
  state.counters["texels/s"] = benchmark::Counter(static_cast<double>(size) * size,
                                                  benchmark::Counter::kIsIterationInvariantRate);
}

BENCHMARK(BM_ManyLights)
    ->Args({512, 1})
    ->Args({512, 0})
    ->Args({48, 0})
    ->Unit(benchmark::kSecond)
    ->UseRealTime()
    ->MeasureProcessCPUTime();

}  // namespace
}  // namespace patina::brdf
