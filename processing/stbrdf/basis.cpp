// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/basis.h"

#include "processing/image/failure.h"

namespace patina::stbrdf {

std::string nameOf(Basis basis) {
  return basis == Basis::kMonomial ? "monomial" : "shifted-legendre";
}

Basis basisNamed(const std::string& name) {
  for (const Basis basis : {Basis::kMonomial, Basis::kLegendre})
    if (name == nameOf(basis)) return basis;
  throw ProcessingError(
      Exit::kBadData, "there is no basis '" + name + "'; there are monomial and shifted-legendre");
}

void basisValues(Basis basis, int degree, double t, double* values) {
  const double x = 2 * t - 1;
  values[0] = 1;
  for (int k = 1; k <= degree; ++k)
    if (basis == Basis::kMonomial)
      values[k] = values[k - 1] * t;
    else
      values[k] = k == 1 ? x : ((2 * k - 1) * x * values[k - 1] - (k - 1) * values[k - 2]) / k;
}

std::vector<double> monomialsOfLegendre(int degree) {
  const int n = degree + 1;
  std::vector<double> m(static_cast<std::size_t>(n) * n, 0);
  // P_j(2t - 1) = sum over k of (-1)^(j+k) C(j,k) C(j+k,k) t^k.
  for (int j = 0; j < n; ++j) {
    double term = j % 2 == 0 ? 1 : -1;
    for (int k = 0; k <= j; ++k) {
      m[static_cast<std::size_t>(k) * n + j] = term;
      term *= -static_cast<double>(j - k) * (j + k + 1) / ((k + 1.0) * (k + 1.0));
    }
  }
  return m;
}

std::vector<double> legendreOfMonomials(int degree) {
  const int n = degree + 1;
  const std::vector<double> m = monomialsOfLegendre(degree);
  std::vector<double> inverse(static_cast<std::size_t>(n) * n, 0);
  for (int column = 0; column < n; ++column)
    for (int row = column; row >= 0; --row) {
      double rest = row == column ? 1 : 0;
      for (int k = row + 1; k <= column; ++k)
        rest -= m[static_cast<std::size_t>(row) * n + k] *
                inverse[static_cast<std::size_t>(k) * n + column];
      inverse[static_cast<std::size_t>(row) * n + column] =
          rest / m[static_cast<std::size_t>(row) * n + row];
    }
  return inverse;
}

void roundToMonomials(const std::vector<double>& inverse, int degree, double* legendre,
                      float* monomials) {
  const int n = degree + 1;
  for (int k = degree; k >= 0; --k) {
    monomials[k] = static_cast<float>(legendre[k] / inverse[static_cast<std::size_t>(k) * n + k]);
    for (int j = 0; j < k; ++j)
      legendre[j] -= monomials[k] * inverse[static_cast<std::size_t>(j) * n + k];
  }
}

std::vector<double> gramMatrix(Basis basis, int degree) {
  const int n = degree + 1;
  std::vector<double> gram(static_cast<std::size_t>(n) * n, 0);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      if (basis == Basis::kMonomial)
        gram[static_cast<std::size_t>(i) * n + j] = 1.0 / (i + j + 1);
      else if (i == j)
        gram[static_cast<std::size_t>(i) * n + j] = 1.0 / (2 * i + 1);
  return gram;
}

}  // namespace patina::stbrdf
