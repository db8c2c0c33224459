// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room only: the two half steps of the factorisation (staf.h): texels for a given
// curve, and the curve for given texels.
#pragma once

#include <array>
#include <vector>

namespace patina::stbrdf::staf {

constexpr int kDegree = 6, kTerms = kDegree + 1;
// Where texels may look at the curve: t' of all of them stays within.
constexpr double kFirst = -1, kLast = 2;
constexpr double kRateLeast = 0.2, kRateMost = 3;

// phi as a sum of Legendre polynomials over [kFirst, kLast]: well conditioned.
struct Curve {
  std::array<double, kTerms> c{};
  double operator()(double at) const;
  double slope(double at) const;
  std::array<double, kTerms> monomials() const;  // of t'^k
};

struct Texel {
  double a = 0, d = 0, rate = 1, offset = 0;
  double error = 0;  // sum of squares over the steps
};

// A, D and the error of a texel at its rate and offset.
void solveLinear(const Curve& curve, const std::vector<double>& times, const double* values,
                 Texel& texel);

// All rates and offsets worth trying, with what the curve looks like at each.
class Grid {
 public:
  Grid(const Curve& curve, const std::vector<double>& times);
  // The best cell, then Gauss and Newton; `texel` stays as it is where that is no better.
  void fit(const double* values, Texel& texel) const;

 private:
  struct Cell {
    double rate, offset;
  };
  void refine(const double* values, Texel& texel) const;

  const Curve& curve_;
  const std::vector<double>& times_;
  std::vector<Cell> cells_;
  std::vector<float> shapes_;  // [cell][t], without their mean, of length 1
};

// The least-squares curve of [i][t] values given each texel's other factors.
Curve fitCurve(const std::vector<Texel>& texels, const std::vector<double>& values,
               const std::vector<double>& times);

// Shapes to start from: what most series do, a ramp, a rise in the middle.
std::vector<Curve> startingCurves(const std::vector<double>& values,
                                  const std::vector<double>& times);

}  // namespace patina::stbrdf::staf
