// SPDX-License-Identifier: GPL-3.0-or-later
// `stbrdf fit` from files to files beside reading and writing the same files alone: 33 steps of
// 512x512 texels, 5 parameters, of a specimen that rusts.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <string>

#include "devices/twin/specimen.h"
#include "processing/image/picture_file.h"
#include "processing/stbrdf/degree_choice.h"
#include "processing/stbrdf/polynomial_fit.h"
#include "processing/stbrdf/samples_file.h"
#include "processing/stbrdf/stbrdf_file.h"
#include "tests/support/temp_folder.h"

namespace patina::stbrdf {
namespace {

namespace fs = std::filesystem;

constexpr int kSteps = 33, kDegree = 3;
constexpr SizePx kSize{512, 512};

class StepFiles {
 public:
  StepFiles() {
    const auto specimen = devices::twin::makeSpecimen("steel_rusting", 1);
    for (int t = 0; t < kSteps; ++t) {
      const auto truth = specimen->surfaceAt(t / (kSteps - 1.0), kSize);
      const fs::path step = folder_ / ("t" + std::to_string(1000 + t));
      fs::create_directories(step);
      Image<float> specular(kSize.width, kSize.height, 1);
      for (std::size_t i = 0; i < specular.texels().size(); ++i)
        specular.texels()[i] = truth.specular.texels()[3 * i];
      writeExr(step / "Diffuse.exr", truth.diffuse.view());
      writeExr(step / "Specular.exr", specular.view());
      writeExr(step / "Roughness.exr", truth.roughness.view());
    }
  }
  const fs::path& path() const { return folder_.path(); }

 private:
  testing::TempFolder folder_;
};

const fs::path& steps() {
  static const StepFiles all;
  return all.path();
}

// What the verb does, the warning of over-fitting included.
StbrdfSet fitted(const SampleSet& input) {
  Progress progress;
  StbrdfSet set;
  set.degree = kDegree;
  set.basis = basisOf(kDegree);
  for (const auto& [name, files] : input.maps) {
    std::vector<TimeSamples> samples;  // a list in braces would be copied
    samples.push_back(readSamples(input, name, progress));
    set.maps.push_back(
        fitMap(samples[0], {.degree = kDegree, .weights = {}, .bounded = false}, progress).map);
    benchmark::DoNotOptimize(chooseDegree(samples, {}));
  }
  return set;
}

// As a command of its own begins: no memory of the round before is at hand.
void beginCold(benchmark::State& state) {
  state.PauseTiming();
  malloc_trim(0);
  state.ResumeTiming();
}

void BM_StbrdfFitOfFiles(benchmark::State& state) {
  Progress progress;
  const testing::TempFolder out;
  int run = 0;
  for (auto _ : state) {
    beginCold(state);
    writeStbrdfSet(out / std::to_string(run++), fitted(openSamples({steps()})), progress);
  }
}

void BM_StbrdfFilesAlone(benchmark::State& state) {
  Progress progress;
  const testing::TempFolder out;
  const SampleSet input = openSamples({steps()});
  const StbrdfSet set = fitted(input);
  int run = 0;
  for (auto _ : state) {
    beginCold(state);
    for (const auto& [name, files] : input.maps)
      benchmark::DoNotOptimize(readSamples(input, name, progress));
    writeStbrdfSet(out / std::to_string(run++), set, progress);
  }
}

BENCHMARK(BM_StbrdfFilesAlone)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_StbrdfFitOfFiles)
    ->MeasureProcessCPUTime()
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace patina::stbrdf
