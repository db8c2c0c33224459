// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/basis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "processing/image/failure.h"

namespace patina::stbrdf {
namespace {

TEST(Basis, LegendrePolynomialsAreOneAtTheEndAndAlternateAtTheStart) {
  double values[kTermsMax];
  basisValues(Basis::kLegendre, kDegreeMax, 1, values);
  for (const double v : values) EXPECT_NEAR(v, 1, 1e-12);
  basisValues(Basis::kLegendre, kDegreeMax, 0, values);
  for (int k = 0; k <= kDegreeMax; ++k) EXPECT_NEAR(values[k], k % 2 == 0 ? 1 : -1, 1e-12);
}

TEST(Basis, BothBasesSpeakOfTheSamePolynomial) {
  for (int degree = 0; degree <= kDegreeMax; ++degree) {
    const std::vector<double> m = monomialsOfLegendre(degree);
    for (const double t : {0.0, 0.3, 0.77, 1.0}) {
      double powers[kTermsMax], legendre[kTermsMax];
      basisValues(Basis::kMonomial, degree, t, powers);
      basisValues(Basis::kLegendre, degree, t, legendre);
      for (int j = 0; j <= degree; ++j) {
        double sum = 0;
        for (int k = 0; k <= degree; ++k) sum += m[k * (degree + 1) + j] * powers[k];
        EXPECT_NEAR(sum, legendre[j], 1e-7) << degree << " " << j << " " << t;
      }
    }
  }
}

TEST(Basis, TheWayBackUndoesTheWayThere) {
  for (const int degree : {0, 1, 3, 6, 12}) {
    const int n = degree + 1;
    const std::vector<double> there = monomialsOfLegendre(degree),
                              back = legendreOfMonomials(degree);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) {
        double sum = 0;
        for (int k = 0; k < n; ++k) sum += there[i * n + k] * back[k * n + j];
        EXPECT_NEAR(sum, i == j ? 1 : 0, 1e-6) << degree;
      }
  }
}

TEST(Basis, TheGramMatrixIntegratesProducts) {
  constexpr int kDegree = 4, kSteps = 20000;
  for (const Basis basis : {Basis::kMonomial, Basis::kLegendre}) {
    const std::vector<double> gram = gramMatrix(basis, kDegree);
    for (int i = 0; i <= kDegree; ++i)
      for (int j = 0; j <= kDegree; ++j) {
        double sum = 0;
        for (int s = 0; s < kSteps; ++s) {
          double v[kTermsMax];
          basisValues(basis, kDegree, (s + 0.5) / kSteps, v);
          sum += v[i] * v[j] / kSteps;
        }
        EXPECT_NEAR(gram[i * (kDegree + 1) + j], sum, 1e-7);
      }
  }
}

// Coefficients near 1000, whose last places are 3e-5.
TEST(Basis, RoundsToMonomialsWithoutMovingThePolynomial) {
  constexpr int kDegree = 6;
  const std::vector<double> inverse = legendreOfMonomials(kDegree);
  const std::array<double, kDegree + 1> truth{0.513, 0.31, -0.277, 0.191, 0.333, -0.289, 0.371};
  std::array<double, kDegree + 1> used = truth;
  float rounded[kDegree + 1];
  roundToMonomials(inverse, kDegree, used.data(), rounded);
  EXPECT_GT(std::abs(rounded[4]), 500);
  double worst = 0;
  for (double t = 0; t <= 1; t += 0.01) {
    double b[kTermsMax], p[kTermsMax], exact = 0, ours = 0;
    basisValues(Basis::kLegendre, kDegree, t, b);
    basisValues(Basis::kMonomial, kDegree, t, p);
    for (int k = 0; k <= kDegree; ++k) {
      exact += truth[k] * b[k];
      ours += rounded[k] * p[k];
    }
    worst = std::max(worst, std::abs(ours - exact));
  }
  EXPECT_LT(worst, 1e-6);  // each rounded by itself: 2e-5
}

TEST(Basis, KnowsItselfByName) {
  for (const Basis basis : {Basis::kMonomial, Basis::kLegendre})
    EXPECT_EQ(basisNamed(nameOf(basis)), basis);
  EXPECT_THROW(basisNamed("chebyshev"), ProcessingError);
}

}  // namespace
}  // namespace patina::stbrdf
