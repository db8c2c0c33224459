// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/time_fit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "processing/image/failure.h"

namespace patina::stbrdf {
namespace {

[[noreturn]] void refuse(const std::string& what) { throw ProcessingError(Exit::kUsage, what); }

constexpr double kDependent = 1e-10;  // of a column's length: nothing new in it

void check(std::span<const double> times, std::span<const double> weights, int degree) {
  if (degree < 0 || degree > kDegreeMax)
    refuse("the degree is " + std::to_string(degree) + "; it lies between 0 and " +
           std::to_string(kDegreeMax));
  if (!weights.empty() && weights.size() != times.size())
    refuse("there are " + std::to_string(times.size()) + " times and " +
           std::to_string(weights.size()) + " weights");
  for (const double t : times)
    if (!(t >= 0 && t <= 1)) refuse("a time is " + std::to_string(t) + "; times lie in [0,1]");
  for (const double w : weights)
    if (!(w > 0 && std::isfinite(w))) refuse("a weight is " + std::to_string(w) + ", not above 0");
  std::vector<double> distinct(times.begin(), times.end());
  std::sort(distinct.begin(), distinct.end());
  const auto count = std::unique(distinct.begin(), distinct.end()) - distinct.begin();
  if (count <= degree)
    refuse("a polynomial of degree " + std::to_string(degree) + " needs " +
           std::to_string(degree + 1) + " different times; there are " + std::to_string(count) +
           ": lower the degree");
}

double dot(const double* a, const double* b, std::size_t n) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

TimeFit::TimeFit(std::span<const double> times, std::span<const double> weights, int degree)
    : degree_(degree), times_(times.begin(), times.end()) {
  check(times, weights, degree);
  weights_.assign(weights.begin(), weights.end());
  if (weights_.empty()) weights_.assign(times.size(), 1.0);
  const std::size_t n = times.size(), terms = static_cast<std::size_t>(degree) + 1;
  orthonormal_.resize(terms * n);
  triangle_.assign(terms * terms, 0);
  for (std::size_t t = 0; t < n; ++t) {
    double values[kTermsMax];
    basisValues(Basis::kLegendre, degree, times_[t], values);
    for (std::size_t k = 0; k < terms; ++k)
      orthonormal_[k * n + t] = std::sqrt(weights_[t]) * values[k];
  }
  // Gram and Schmidt, twice: orthonormal to the last bit.
  for (std::size_t j = 0; j < terms; ++j) {
    double* column = &orthonormal_[j * n];
    const double before = std::sqrt(dot(column, column, n));
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t k = 0; k < j; ++k) {
        const double along = dot(&orthonormal_[k * n], column, n);
        triangle_[k * terms + j] += along;
        for (std::size_t t = 0; t < n; ++t) column[t] -= along * orthonormal_[k * n + t];
      }
    const double length = std::sqrt(dot(column, column, n));
    if (!(length > kDependent * before))
      refuse("the times lie too close together for degree " + std::to_string(degree) +
             ": lower it");
    triangle_[j * terms + j] = length;
    for (std::size_t t = 0; t < n; ++t) column[t] /= length;
  }
  // R c = Q^t sqrt(W) y, for every unit vector y.
  projection_.assign(terms * n, 0);
  for (std::size_t t = 0; t < n; ++t)
    for (std::size_t k = terms; k-- > 0;) {
      double rest = orthonormal_[k * n + t] * std::sqrt(weights_[t]);
      for (std::size_t j = k + 1; j < terms; ++j)
        rest -= triangle_[k * terms + j] * projection_[j * n + t];
      projection_[k * n + t] = rest / triangle_[k * terms + k];
    }
}

}  // namespace patina::stbrdf
