// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomial texture maps (Malzbender et al. 2001, eq. 1), the judge beside a reflectance fit: each
// channel of each texel is a polynomial of six terms in the light's x and y, by least squares on
// stored values.
#pragma once

#include <vector>

#include "processing/brdf/vector.h"
#include "processing/image/image.h"

namespace patina::brdf {

struct PolynomialMap {
  std::vector<Image<float>> terms;  // 6 of [h][w][c]: x^2 y^2 xy x y 1
};
// Throws ProcessingError(kBadData): fewer than 6 lights, or lights that do not tell the terms
// apart.
PolynomialMap fitPolynomialMap(const std::vector<ImageView<const float>>& stored,
                               const std::vector<Vec3>& lights);
Image<float> polynomialUnder(const PolynomialMap& map, const Vec3& l);

}  // namespace patina::brdf
