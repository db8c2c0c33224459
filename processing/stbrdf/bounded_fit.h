// SPDX-License-Identifier: GPL-3.0-or-later
// The polynomial that stays within a range: for the few series whose least-squares fit leaves it.
//
//   minimise sum over t of w(t) (p(t) - y(t))^2   subject to low <= p(t) <= high
//
// at 257 Chebyshev times. Between those it may leave by at most a 1 / cos(degree pi / 512) - 1 part
// of half the range: 8e-5 of [0,1] at degree 3, 1.4e-3 at degree 12.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "processing/image/failure.h"
#include "processing/stbrdf/time_fit.h"

namespace patina::stbrdf {

class BoundedFit {
 public:
  BoundedFit(const TimeFit& fit, double low, double high);

  // `c`: coefficients of the unbounded fit in shifted Legendre polynomials; replaced where that fit
  // leaves the range. Returns whether it did. Exact (an active-set method on the dual problem);
  // O(257 * degree) a change of the active set.
  bool bound(double* c) const;

  // The same for planes of `count` series. Multi-threaded. Returns how many were changed.
  std::int64_t bound(std::span<float* const> coefficients, std::size_t count) const;

 private:
  struct Constraint {
    int time;
    double sign;  // +1: p <= high, -1: p >= low
  };
  struct Worst {
    Constraint at;
    double by;
  };
  Worst worst(const double* c) const;
  double value(int time, const double* c) const;
  double excess(const Constraint& at, const double* c) const;
  bool solveEqualities(const std::vector<Constraint>& active, const double* c0,
                       std::vector<double>& multipliers) const;
  void shrinkInto(double* c) const;

  int terms_;
  double low_, high_;
  std::vector<double> basis_;      // [time][k]
  std::vector<double> influence_;  // [time][k]: (B^t W B)^-1 basis
};

}  // namespace patina::stbrdf
