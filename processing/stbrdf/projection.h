// SPDX-License-Identifier: GPL-3.0-or-later
// The fit's inner loop: coefficients of very many series at once, limited by the memory's
// bandwidth. Every sample is read once. float32, multiplied and added in the order of the steps, so
// that all SIMD paths and any number of threads give the same bytes.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "processing/stbrdf/time_fit.h"

namespace patina::stbrdf {

class Projection {
 public:
  // Coefficients come out in `basis`: shifted Legendre polynomials as they are projected, monomials
  // from those in float64.
  Projection(const TimeFit& fit, Basis basis);

  int steps() const { return steps_; }
  int terms() const { return terms_; }

  // samples[t] and coefficients[k] point to planes of `count` floats. Multi-threaded.
  void apply(std::span<const float* const> samples, std::span<float* const> coefficients,
             std::size_t count) const;

 private:
  int steps_, terms_;
  std::vector<float> weights_;  // [t][k]
  std::vector<double> change_;  // legendreOfMonomials(); empty: none
};

// rms[i] = weighted root mean square over the steps of samples minus polynomial, in float64 inside.
void residualRms(const TimeFit& fit, Basis basis, std::span<const float* const> samples,
                 std::span<const float* const> coefficients, std::span<float> rms);

}  // namespace patina::stbrdf
