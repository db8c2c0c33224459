// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/stbrdf_set.h"

#include <algorithm>

#include "processing/image/parallel_rows.h"

namespace patina::stbrdf {

Image<float> evaluate(const TimeMap& map, Basis basis, double t, Clamp clamp) {
  PATINA_CHECK(t >= 0 && t <= 1 && !map.coefficients.empty());
  const int degree = static_cast<int>(map.coefficients.size()) - 1;
  double values[kTermsMax];
  basisValues(basis, degree, t, values);
  const Image<float>& first = map.coefficients[0];
  Image<float> out(first.width(), first.height(), first.channels());
  const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(first.width()) * first.channels();
  forEachRow(first.height(), count * (degree + 1), [&](int y) {
    // float64: monomials of a lively texel are large and cancel.
    std::vector<double> sums(static_cast<std::size_t>(count), 0);
    for (int k = 0; k <= degree; ++k) {
      const float* a = map.coefficients[static_cast<std::size_t>(k)].view().row(y);
      for (std::ptrdiff_t i = 0; i < count; ++i) sums[i] += values[k] * a[i];
    }
    float* row = out.view().row(y);
    for (std::ptrdiff_t i = 0; i < count; ++i) row[i] = static_cast<float>(sums[i]);
    if (clamp == Clamp::kToRange)
      for (std::ptrdiff_t i = 0; i < count; ++i) row[i] = std::clamp(row[i], map.low, map.high);
  });
  return out;
}

Image<float> evaluate(const TimeMap& map, Basis basis, ImageView<const float> times, Clamp clamp) {
  PATINA_CHECK(!map.coefficients.empty() && map.coefficients[0].size() == times.size() &&
               times.channels == 1);
  const int degree = static_cast<int>(map.coefficients.size()) - 1;
  const Image<float>& first = map.coefficients[0];
  Image<float> out(first.width(), first.height(), first.channels());
  forEachRow(first.height(), std::int64_t{first.width()} * first.channels() * (degree + 1) * 4,
             [&](int y) {
               double values[kTermsMax];
               for (int x = 0; x < first.width(); ++x) {
                 basisValues(basis, degree, times.at(x, y), values);
                 for (int c = 0; c < first.channels(); ++c) {
                   double sum = 0;
                   for (int k = 0; k <= degree; ++k)
                     sum += values[k] * map.coefficients[static_cast<std::size_t>(k)].at(x, y, c);
                   const auto value = static_cast<float>(sum);
                   out.at(x, y, c) =
                       clamp == Clamp::kToRange ? std::clamp(value, map.low, map.high) : value;
                 }
               }
             });
  return out;
}

void convert(StbrdfSet& set, Basis basis) {
  if (set.basis == basis) return;
  const int n = set.degree + 1;
  const std::vector<double> legendre = legendreOfMonomials(set.degree);
  for (TimeMap& map : set.maps) {
    const Image<float>& first = map.coefficients[0];
    const std::ptrdiff_t count = static_cast<std::ptrdiff_t>(first.width()) * first.channels();
    forEachRow(first.height(), count * n * n, [&](int y) {
      for (std::ptrdiff_t i = 0; i < count; ++i) {
        double in[kTermsMax], sums[kTermsMax] = {};
        float to[kTermsMax];
        for (int k = 0; k < n; ++k)
          in[k] = map.coefficients[static_cast<std::size_t>(k)].view().row(y)[i];
        if (basis == Basis::kMonomial) {
          roundToMonomials(legendre, set.degree, in, to);
        } else {
          for (int k = 0; k < n; ++k) {
            for (int j = k; j < n; ++j)
              sums[k] += legendre[static_cast<std::size_t>(k) * n + j] * in[j];
            to[k] = static_cast<float>(sums[k]);
          }
        }
        for (int k = 0; k < n; ++k)
          map.coefficients[static_cast<std::size_t>(k)].view().row(y)[i] = to[k];
      }
    });
  }
  set.basis = basis;
}

}  // namespace patina::stbrdf
