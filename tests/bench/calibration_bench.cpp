// SPDX-License-Identifier: GPL-3.0-or-later
// A 24-megapixel raw file to calibrated linear light, beside memcpy of as many bytes on the same
// cores. Bytes of numbers, masters and result count: 14 a pixel; of memcpy, those read and written.
#include <benchmark/benchmark.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstring>

#include "calibration/sensor/radiance.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

constexpr int kWidth = 6000, kHeight = 4000;
constexpr std::int64_t kBytes = std::int64_t{14} * kWidth * kHeight;

void BM_RadianceOf24Megapixels(benchmark::State& state) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(kWidth, kHeight, 1);
  for (std::size_t i = 0; i < raw.samples.texels().size(); ++i)
    raw.samples.texels()[i] = static_cast<std::uint16_t>(mixBits(i) & 4095);
  raw.black_level = 64;
  raw.white_level = 4095;
  const Image<float> dark(kWidth, kHeight, 1, 0.001f), flat(kWidth, kHeight, 1, 0.9f);
  std::vector<Defect> defects;
  for (int i = 0; i < kWidth * kHeight / 20'000; ++i)
    defects.push_back({i * 4999 % kWidth, i * 3989 % kHeight, DefectKind::kHot, 1});
  const SensorCorrection correction =
      prepareCorrection({kWidth, kHeight}, 1, raw.cfa, dark.view(), flat.view(), defects);
  Image<float> light(kWidth, kHeight, 1);
  for (auto _ : state) {
    toRadiance(raw, correction, {1.1f, 1, 1.2f}, light.view());
    benchmark::DoNotOptimize(light.texels().data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * kBytes);
}
BENCHMARK(BM_RadianceOf24Megapixels)->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_MemcpyOnAllCores(benchmark::State& state) {
  const std::vector<char> from(kBytes / 2, 1);
  std::vector<char> to(kBytes / 2);
  for (auto _ : state) {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, from.size(), 1 << 20),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        std::memcpy(to.data() + range.begin(), from.data() + range.begin(),
                                    range.size());
                      });
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * kBytes);
}
BENCHMARK(BM_MemcpyOnAllCores)->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_MemcpyInOneCall(benchmark::State& state) {
  const std::vector<char> from(kBytes / 2, 1);
  std::vector<char> to(kBytes / 2);
  for (auto _ : state) {
    std::memcpy(to.data(), from.data(), from.size());
    benchmark::DoNotOptimize(to.data());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * kBytes);
}
BENCHMARK(BM_MemcpyInOneCall)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace patina::calibration
