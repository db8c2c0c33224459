// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/projection.h"

#include <immintrin.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "processing/image/failure.h"
#include "processing/image/simd_path.h"

namespace patina::stbrdf {
namespace {

constexpr std::size_t kBlock = 64;  // series a block: a cache line or more of each plane
constexpr std::size_t kBlocksATask = 128;

struct Job {
  const float* const* samples;
  const float* weights;  // [t][k]
  const double* change;  // legendreOfMonomials() or null
  int steps, terms;
};

// sums [terms][kBlock] of `width` series from `at` on.
void sumPlain(const Job& job, std::size_t at, std::size_t width, float* sums) {
  std::fill_n(sums, static_cast<std::size_t>(job.terms) * kBlock, 0.0f);
  for (int t = 0; t < job.steps; ++t) {
    const float* y = job.samples[t] + at;
    for (int k = 0; k < job.terms; ++k) {
      const float w = job.weights[t * job.terms + k];
      float* sum = sums + static_cast<std::size_t>(k) * kBlock;
      for (std::size_t i = 0; i < width; ++i) sum[i] += w * y[i];
    }
  }
}

// A plane a step are more streams than the processor's own prefetcher follows.
[[gnu::always_inline]] inline void prefetchNextBlock(const float* y) {
  _mm_prefetch(reinterpret_cast<const char*>(y + kBlock), _MM_HINT_T0);
}

// As many accumulators as there are registers: one lane is 16 or 8 series.
template <int K>
[[gnu::target("avx512f")]] void sumAvx512(const Job& job, std::size_t at, float* sums) {
  constexpr int kLanes = K <= 7 ? 4 : 2;
  for (std::size_t part = 0; part < kBlock; part += 16 * kLanes) {
    __m512 sum[K][kLanes];
    for (int k = 0; k < K; ++k)
      for (int u = 0; u < kLanes; ++u) sum[k][u] = _mm512_setzero_ps();
    for (int t = 0; t < job.steps; ++t) {
      const float* y = job.samples[t] + at + part;
      __m512 v[kLanes];
      for (int u = 0; u < kLanes; ++u) {
        v[u] = _mm512_loadu_ps(y + 16 * u);
        prefetchNextBlock(y + 16 * u);
      }
      for (int k = 0; k < K; ++k) {
        const __m512 w = _mm512_set1_ps(job.weights[t * K + k]);
        for (int u = 0; u < kLanes; ++u)
          sum[k][u] = _mm512_add_ps(sum[k][u], _mm512_mul_ps(w, v[u]));
      }
    }
    for (int k = 0; k < K; ++k)
      for (int u = 0; u < kLanes; ++u)
        _mm512_storeu_ps(sums + k * kBlock + part + 16 * u, sum[k][u]);
  }
}

template <int K>
[[gnu::target("avx2")]] void sumAvx2(const Job& job, std::size_t at, float* sums) {
  constexpr int kLanes = K <= 3 ? 4 : K <= 6 ? 2 : 1;
  for (std::size_t part = 0; part < kBlock; part += 8 * kLanes) {
    __m256 sum[K][kLanes];
    for (int k = 0; k < K; ++k)
      for (int u = 0; u < kLanes; ++u) sum[k][u] = _mm256_setzero_ps();
    for (int t = 0; t < job.steps; ++t) {
      const float* y = job.samples[t] + at + part;
      __m256 v[kLanes];
      for (int u = 0; u < kLanes; ++u) v[u] = _mm256_loadu_ps(y + 8 * u);
      prefetchNextBlock(y);
      for (int k = 0; k < K; ++k) {
        const __m256 w = _mm256_set1_ps(job.weights[t * K + k]);
        for (int u = 0; u < kLanes; ++u)
          sum[k][u] = _mm256_add_ps(sum[k][u], _mm256_mul_ps(w, v[u]));
      }
    }
    for (int k = 0; k < K; ++k)
      for (int u = 0; u < kLanes; ++u)
        _mm256_storeu_ps(sums + k * kBlock + part + 8 * u, sum[k][u]);
  }
}

using Sum = void (*)(const Job&, std::size_t, float*);

template <std::size_t... K>
Sum sumFor(SimdPath path, int terms, std::index_sequence<K...>) {
  static constexpr std::array<Sum, sizeof...(K)> kAvx512{sumAvx512<static_cast<int>(K) + 1>...};
  static constexpr std::array<Sum, sizeof...(K)> kAvx2{sumAvx2<static_cast<int>(K) + 1>...};
  const auto k = static_cast<std::size_t>(terms) - 1;
  if (path == SimdPath::kAvx512) return kAvx512[k];
  if (path == SimdPath::kAvx2) return kAvx2[k];
  return [](const Job& job, std::size_t at, float* sums) { sumPlain(job, at, kBlock, sums); };
}

// In place: from Legendre polynomials to monomials, as roundToMonomials() does.
[[gnu::always_inline]] inline void changeBasis(const double* inverse, int terms, float* sums) {
  double rest[kTermsMax * kBlock];
  for (std::size_t i = 0; i < static_cast<std::size_t>(terms) * kBlock; ++i) rest[i] = sums[i];
  for (int k = terms; k-- > 0;) {
    const double lead = 1 / inverse[k * terms + k];
    float* to = sums + static_cast<std::size_t>(k) * kBlock;
    const double* from = rest + static_cast<std::size_t>(k) * kBlock;
    for (std::size_t i = 0; i < kBlock; ++i) to[i] = static_cast<float>(from[i] * lead);
    for (int j = 0; j < k; ++j) {
      const double share = inverse[j * terms + k];
      double* lower = rest + static_cast<std::size_t>(j) * kBlock;
      for (std::size_t i = 0; i < kBlock; ++i) lower[i] -= share * to[i];
    }
  }
}

void changePlain(const double* inverse, int terms, float* sums) {
  changeBasis(inverse, terms, sums);
}
[[gnu::target("avx2")]] void changeAvx2(const double* inverse, int terms, float* sums) {
  changeBasis(inverse, terms, sums);
}
[[gnu::target("avx512f")]] void changeAvx512(const double* inverse, int terms, float* sums) {
  changeBasis(inverse, terms, sums);
}

// Past the caches: nobody reads a coefficient before all are written.
void store(const float* sums, std::size_t width, float* to) {
  if (width == kBlock && reinterpret_cast<std::uintptr_t>(to) % 16 == 0)
    for (std::size_t i = 0; i < kBlock; i += 4) _mm_stream_ps(to + i, _mm_load_ps(sums + i));
  else
    std::copy_n(sums, width, to);
}

// What is left of `width` series from `at` on.
struct Residual {
  const float* const* samples;
  const float* const* coefficients;
  const double* values;   // [t][k] of the basis
  const double* weights;  // [t]
  int steps, terms;
};

// sum[kBlock]: weighted squares over all steps.
[[gnu::always_inline]] inline void squaresOfSome(const Residual& job, std::size_t at,
                                                 std::size_t width, double* sum) {
  std::fill_n(sum, kBlock, 0.0);
  for (int t = 0; t < job.steps; ++t) {
    double p[kBlock] = {};
    for (int k = 0; k < job.terms; ++k) {
      const double b = job.values[t * job.terms + k];
      const float* c = job.coefficients[k] + at;
      for (std::size_t i = 0; i < width; ++i) p[i] += b * c[i];
    }
    const float* y = job.samples[t] + at;
    const double w = job.weights[t];
    for (std::size_t i = 0; i < width; ++i) sum[i] += w * (y[i] - p[i]) * (y[i] - p[i]);
  }
}

// A whole block has a length that the compiler knows.
[[gnu::always_inline]] inline void squaresOf(const Residual& job, std::size_t at, std::size_t width,
                                             double* sum) {
  if (width == kBlock)
    squaresOfSome(job, at, kBlock, sum);
  else
    squaresOfSome(job, at, width, sum);
}

void squaresPlain(const Residual& job, std::size_t at, std::size_t width, double* sum) {
  squaresOf(job, at, width, sum);
}
[[gnu::target("avx2")]] void squaresAvx2(const Residual& job, std::size_t at, std::size_t width,
                                         double* sum) {
  squaresOf(job, at, width, sum);
}
[[gnu::target("avx512f")]] void squaresAvx512(const Residual& job, std::size_t at,
                                              std::size_t width, double* sum) {
  squaresOf(job, at, width, sum);
}

}  // namespace

Projection::Projection(const TimeFit& fit, Basis basis)
    : steps_(fit.steps()), terms_(fit.degree() + 1) {
  for (int t = 0; t < steps_; ++t)
    for (int k = 0; k < terms_; ++k)
      weights_.push_back(static_cast<float>(
          fit.projection()[static_cast<std::size_t>(k) * static_cast<std::size_t>(steps_) +
                           static_cast<std::size_t>(t)]));
  if (basis == Basis::kMonomial && terms_ > 1) change_ = legendreOfMonomials(fit.degree());
}

void Projection::apply(std::span<const float* const> samples, std::span<float* const> coefficients,
                       std::size_t count) const {
  PATINA_CHECK(static_cast<int>(samples.size()) == steps_ &&
               static_cast<int>(coefficients.size()) == terms_);
  const Job job{samples.data(), weights_.data(), change_.empty() ? nullptr : change_.data(), steps_,
                terms_};
  const SimdPath path = simdPath();
  const Sum sum = sumFor(path, terms_, std::make_index_sequence<kTermsMax>());
  const auto change = path == SimdPath::kAvx512 ? changeAvx512
                      : path == SimdPath::kAvx2 ? changeAvx2
                                                : changePlain;
  const std::size_t blocks = (count + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, kBlocksATask),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      alignas(64) float sums[kTermsMax * kBlock];
                      for (std::size_t block = range.begin(); block != range.end(); ++block) {
                        const std::size_t at = block * kBlock, width = std::min(kBlock, count - at);
                        if (width == kBlock)
                          sum(job, at, sums);
                        else
                          sumPlain(job, at, width, sums);
                        if (job.change) change(job.change, terms_, sums);
                        for (int k = 0; k < terms_; ++k)
                          store(sums + static_cast<std::size_t>(k) * kBlock, width,
                                coefficients[static_cast<std::size_t>(k)] + at);
                      }
                      _mm_sfence();
                    });
}

void residualRms(const TimeFit& fit, Basis basis, std::span<const float* const> samples,
                 std::span<const float* const> coefficients, std::span<float> rms) {
  const int steps = fit.steps(), terms = fit.degree() + 1;
  PATINA_CHECK(static_cast<int>(samples.size()) == steps &&
               static_cast<int>(coefficients.size()) == terms);
  std::vector<double> values(static_cast<std::size_t>(steps) * static_cast<std::size_t>(terms));
  double weight_sum = 0;
  for (int t = 0; t < steps; ++t) {
    basisValues(basis, fit.degree(), fit.times()[static_cast<std::size_t>(t)],
                &values[static_cast<std::size_t>(t) * static_cast<std::size_t>(terms)]);
    weight_sum += fit.weights()[static_cast<std::size_t>(t)];
  }
  const Residual job{
      samples.data(), coefficients.data(), values.data(), fit.weights().data(), steps, terms};
  const SimdPath path = simdPath();
  const auto squares = path == SimdPath::kAvx512 ? squaresAvx512
                       : path == SimdPath::kAvx2 ? squaresAvx2
                                                 : squaresPlain;
  constexpr std::size_t kGrain = 4096;
  const std::size_t blocks = (rms.size() + kBlock - 1) / kBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, blocks, kGrain / kBlock),
                    [&](const tbb::blocked_range<std::size_t>& range) {
                      for (std::size_t block = range.begin(); block != range.end(); ++block) {
                        const std::size_t at = block * kBlock,
                                          width = std::min(kBlock, rms.size() - at);
                        double sum[kBlock];
                        squares(job, at, width, sum);
                        for (std::size_t i = 0; i < width; ++i)
                          rms[at + i] = static_cast<float>(std::sqrt(sum[i] / weight_sum));
                      }
                    });
}

}  // namespace patina::stbrdf
