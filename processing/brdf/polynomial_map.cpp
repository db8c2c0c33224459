// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/polynomial_map.h"

#include <array>
#include <cmath>

#include "processing/image/parallel_rows.h"

namespace patina::brdf {
namespace {

constexpr std::size_t kTerms = 6;
using Terms = std::array<double, kTerms>;

Terms termsOf(const Vec3& l) {
  const double x = l.x, y = l.y;
  return {x * x, y * y, x * y, x, y, 1};
}

// Rows of the least-squares solution: coefficient = sum over pictures of row * stored. Gauss with
// pivots on the normal equations.
std::vector<Terms> solver(const std::vector<Vec3>& lights) {
  std::array<std::array<double, kTerms>, kTerms> m{};
  std::vector<Terms> right;
  for (const Vec3& l : lights) {
    const Terms t = termsOf(l);
    for (std::size_t i = 0; i < kTerms; ++i)
      for (std::size_t j = 0; j < kTerms; ++j) m[i][j] += t[i] * t[j];
    right.push_back(t);
  }
  for (std::size_t p = 0; p < kTerms; ++p) {
    std::size_t best = p;
    for (std::size_t i = p + 1; i < kTerms; ++i)
      if (std::abs(m[i][p]) > std::abs(m[best][p])) best = i;
    if (!(std::abs(m[best][p]) > 1e-9))
      throw ProcessingError(Exit::kBadData,
                            "the lights do not tell the six terms of a polynomial map apart");
    std::swap(m[p], m[best]);
    for (Terms& r : right) std::swap(r[p], r[best]);
    for (std::size_t i = 0; i < kTerms; ++i) {
      if (i == p) continue;
      const double factor = m[i][p] / m[p][p];
      for (std::size_t j = p; j < kTerms; ++j) m[i][j] -= factor * m[p][j];
      for (Terms& r : right) r[i] -= factor * r[p];
    }
  }
  for (Terms& r : right)
    for (std::size_t i = 0; i < kTerms; ++i) r[i] /= m[i][i];
  return right;
}

}  // namespace

PolynomialMap fitPolynomialMap(const std::vector<ImageView<const float>>& stored,
                               const std::vector<Vec3>& lights) {
  PATINA_CHECK(stored.size() == lights.size());
  if (lights.size() < kTerms)
    throw ProcessingError(Exit::kBadData, "a polynomial map needs at least 6 lights");
  const std::vector<Terms> rows = solver(lights);
  const ImageView<const float>& first = stored[0];
  PolynomialMap map;
  for (std::size_t i = 0; i < kTerms; ++i)
    map.terms.emplace_back(first.width, first.height, first.channels);
  const int width = first.width * first.channels;
  forEachRow(first.height, std::int64_t{width} * 6 * static_cast<int>(stored.size()), [&](int y) {
    for (std::size_t i = 0; i < kTerms; ++i) {
      float* to = map.terms[i].view().row(y);
      for (std::size_t s = 0; s < stored.size(); ++s) {
        const auto factor = static_cast<float>(rows[s][i]);
        const float* from = stored[s].row(y);
        for (int x = 0; x < width; ++x) to[x] += factor * from[x];
      }
    }
  });
  return map;
}

Image<float> polynomialUnder(const PolynomialMap& map, const Vec3& l) {
  const Image<float>& first = map.terms[0];
  Image<float> out(first.width(), first.height(), first.channels());
  const Terms t = termsOf(l);
  for (std::size_t i = 0; i < kTerms; ++i)
    for (std::size_t v = 0; v < out.texels().size(); ++v)
      out.texels()[v] += static_cast<float>(t[i]) * map.terms[i].texels()[v];
  return out;
}

}  // namespace patina::brdf
