// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomials of time, t in [0,1] over the whole process, in one of two bases. Monomials are what
// people and other programs read; shifted Legendre polynomials P_k(2t - 1) keep float32
// coefficients accurate at any degree, since they are orthogonal on [0,1].
#pragma once

#include <string>
#include <vector>

namespace patina::stbrdf {

enum class Basis { kMonomial, kLegendre };

constexpr int kDegreeMax = 12;
constexpr int kMonomialDegreeMax = 6;  // above, monomials lose what float32 can hold
constexpr int kTermsMax = kDegreeMax + 1;

constexpr Basis basisOf(int degree) {
  return degree <= kMonomialDegreeMax ? Basis::kMonomial : Basis::kLegendre;
}
std::string nameOf(Basis basis);            // "monomial" "shifted-legendre"
Basis basisNamed(const std::string& name);  // throws ProcessingError(kBadData)

// values[k] = k-th basis function at t, for k = 0 ... degree.
void basisValues(Basis basis, int degree, double t, double* values);

// [k][j], row-major: coefficient k of t^k in P_j(2t - 1); zero for k > j.
std::vector<double> monomialsOfLegendre(int degree);
// Its inverse: t^j as a sum of P_k.
std::vector<double> legendreOfMonomials(int degree);

// One polynomial as float32 monomials: from the highest power down, and what rounding a coefficient
// did to the polynomial is taken up by the lower ones. The error left is at most the sum of
// half a unit in the last place of a_k over C(2k,k), instead of the sum of all those halves.
// `inverse`: legendreOfMonomials(degree); `legendre` is used up.
void roundToMonomials(const std::vector<double>& inverse, int degree, double* legendre,
                      float* monomials);

// [i][j]: integral over t in [0,1] of the product of basis functions i and j; the distance of two
// polynomials whose coefficients differ by b is b^t G b (Meister et al. 2021, eq. 11 to 14).
std::vector<double> gramMatrix(Basis basis, int degree);

}  // namespace patina::stbrdf
