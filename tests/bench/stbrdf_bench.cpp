// SPDX-License-Identifier: GPL-3.0-or-later
// The fit of polynomials in time, 512x512 texels x 5 parameters x 33 steps in memory, beside what
// reading the same samples costs in the same run. polyfit_numpy.py is the same in numpy.
#include <benchmark/benchmark.h>
#include <tbb/parallel_for.h>

#include <numeric>
#include <vector>

#include "processing/stbrdf/projection.h"

namespace patina::stbrdf {
namespace {

constexpr std::size_t kSeries = 512 * 512 * 5;
constexpr int kSteps = 33;

class Samples {
 public:
  Samples() : values_(kSteps, std::vector<float>(kSeries)) {
    tbb::parallel_for(0, kSteps, [&](int t) {
      for (std::size_t i = 0; i < kSeries; ++i)
        values_[static_cast<std::size_t>(t)][i] =
            static_cast<float>((i * 2654435761u + static_cast<unsigned>(t) * 977u) >> 8 & 0xffff) /
            65536.0f;
    });
    for (const auto& plane : values_) planes_.push_back(plane.data());
  }
  const std::vector<const float*>& planes() const { return planes_; }

 private:
  std::vector<std::vector<float>> values_;
  std::vector<const float*> planes_;
};

const Samples& samples() {
  static const Samples all;
  return all;
}

// As wide as any machine loads; the sum is kept so that nothing is left out.
void BM_ReadSamples(benchmark::State& state) {
  const auto& planes = samples().planes();
  for (auto _ : state)
    tbb::parallel_for(0, kSteps * 16, [&](int part) {
      typedef int Lanes __attribute__((vector_size(64), aligned(4), may_alias));
      const std::size_t count = kSeries / 16;
      const float* from =
          planes[static_cast<std::size_t>(part / 16)] + static_cast<std::size_t>(part % 16) * count;
      Lanes sum{};
      for (std::size_t i = 0; i + 16 <= count; i += 16)
        sum |= *reinterpret_cast<const Lanes*>(from + i);
      benchmark::DoNotOptimize(sum);
    });
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(kSeries) * kSteps * 4);
}
BENCHMARK(BM_ReadSamples)->UseRealTime()->Unit(benchmark::kMillisecond);

void BM_FitPolynomials(benchmark::State& state) {
  const int degree = static_cast<int>(state.range(0));
  const Basis basis = state.range(1) == 0 ? Basis::kLegendre : Basis::kMonomial;
  std::vector<double> times(kSteps);
  for (int t = 0; t < kSteps; ++t) times[static_cast<std::size_t>(t)] = t / (kSteps - 1.0);
  const Projection projection(TimeFit(times, {}, degree), basis);
  std::vector<std::vector<float>> coefficients(static_cast<std::size_t>(degree) + 1,
                                               std::vector<float>(kSeries));
  std::vector<float*> out;
  for (auto& plane : coefficients) out.push_back(plane.data());
  for (auto _ : state) projection.apply(samples().planes(), out, kSeries);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(kSeries) *
                          (kSteps + degree + 1) * 4);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kSeries));
}
BENCHMARK(BM_FitPolynomials)
    ->ArgNames({"degree", "monomials"})
    ->ArgsProduct({{3, 4, 5}, {0, 1}})
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace patina::stbrdf
