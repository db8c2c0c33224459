// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/ggx.h"

#include <algorithm>

namespace patina::brdf {

float ggx(const Vec3& n, const Vec3& l, const Vec3& v, float f0, float alpha) {
  const float n_l = dot(n, l), n_v = dot(n, v);
  if (!(n_l > 0) || !(n_v > 0)) return 0;
  const Vec3 h = halfway(l, v);
  return ggxDistribution(std::max(dot(n, h), 0.0f), alpha) * smithVisibility(n_l, n_v, alpha) *
         schlickFresnel(f0, std::max(dot(v, h), 0.0f));
}

// Half vectors are drawn with density D(h) (n.h): cos^2 = (1-u) / (1 + (a^2-1) u), Walter eq. 35.
// Then f (n.l) dl = F V 4 (v.h) (n.l) / (n.h) du.
float ggxDirectionalAlbedo(float n_v, float f0, float alpha, int rings) {
  const double a2 = static_cast<double>(alpha) * alpha;
  const double sin_v = std::sqrt(std::max(0.0, 1.0 - static_cast<double>(n_v) * n_v));
  const int columns = 2 * rings;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double u = (i + 0.5) / rings;
    const double n_h = std::sqrt((1 - u) / (1 + (a2 - 1) * u));
    const double sin_h = std::sqrt(std::max(0.0, 1 - n_h * n_h));
    for (int j = 0; j < columns; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / columns;
      const double v_h = sin_v * sin_h * std::cos(phi) + n_v * n_h;
      const double n_l = 2 * v_h * n_h - n_v;
      if (v_h <= 0 || n_l <= 0) continue;
      const double f = schlickFresnel(f0, static_cast<float>(v_h));
      const double vis = smithVisibility(static_cast<float>(n_l), n_v, alpha);
      sum += f * vis * 4 * v_h * n_l / n_h;
    }
  }
  return static_cast<float>(sum / (static_cast<double>(rings) * columns));
}

}  // namespace patina::brdf
