// SPDX-License-Identifier: GPL-3.0-or-later
// The small matrices of a fit of polynomials to samples at given times: everything that does not
// depend on the samples. Weighted least squares by an orthonormal basis of the times, in float64.
//
//   p(t) = sum over k of c_k P_k(2t - 1)        Meister et al. 2021, eq. 8, in Legendre polynomials
//   c = P y                                     P [k][t], `projection`
#pragma once

#include <span>
#include <vector>

#include "processing/stbrdf/basis.h"

namespace patina::stbrdf {

class TimeFit {
 public:
  // Times in [0,1], in any order, uneven, repeated; steps that are missing are simply not there.
  // `weights`: of squared errors, > 0; empty: all 1. Throws ProcessingError(kUsage): a degree that
  // needs more distinct times than there are, times outside [0,1]. O(steps * degree^2).
  TimeFit(std::span<const double> times, std::span<const double> weights, int degree);

  int degree() const { return degree_; }
  int steps() const { return static_cast<int>(times_.size()); }
  const std::vector<double>& times() const { return times_; }
  const std::vector<double>& weights() const { return weights_; }

  // [k][t], for coefficients of shifted Legendre polynomials.
  const std::vector<double>& projection() const { return projection_; }
  // [k][t]: row k is orthonormal to the others and spans, with those before it, the weighted
  // polynomials of degree k: the fit of degree d is the projection on the first d + 1 rows.
  const std::vector<double>& orthonormal() const { return orthonormal_; }
  // [k][j], upper triangle R: sqrt(w(t)) P_j(2t - 1) = sum over k of orthonormal[k][t] R[k][j].
  const std::vector<double>& triangle() const { return triangle_; }

 private:
  int degree_;
  std::vector<double> times_, weights_, projection_, orthonormal_, triangle_;
};

}  // namespace patina::stbrdf
