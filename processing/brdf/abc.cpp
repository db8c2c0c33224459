// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/abc.h"

namespace patina::brdf {

float abc(const AbcLobe& lobe, int color, const Vec3& n, const Vec3& l, const Vec3& v) {
  const float n_l = dot(n, l), n_v = dot(n, v);
  if (!(n_l > 0) || !(n_v > 0)) return 0;
  const Vec3 h = halfway(l, v);
  return lobe.a[static_cast<std::size_t>(color)] *
         abcShape(lobe, std::max(dot(n, h), 0.0f), n_l, n_v, std::max(dot(v, h), 0.0f));
}

double abcExact(const AbcLobe& lobe, int color, double n_h, double n_l, double n_v, double v_h) {
  const double d =
      lobe.a[static_cast<std::size_t>(color)] / std::pow(1 + lobe.b * (1 - n_h), double{lobe.c});
  const double g = std::min({1.0, 2 * n_h * n_l / v_h, 2 * n_h * n_v / v_h});
  // Fresnel's equations with the refracted angle by Snell's law.
  const double cos_t = std::sqrt(1 - (1 - v_h * v_h) / (double{lobe.ior} * lobe.ior));
  const double s = (v_h - lobe.ior * cos_t) / (v_h + lobe.ior * cos_t);
  const double p = (lobe.ior * v_h - cos_t) / (lobe.ior * v_h + cos_t);
  return (s * s + p * p) / 2 * d * g / (M_PI * n_l * n_v);
}

// Over half vectors: dl = 4 (v.h) dh, dh = dq dphi with q = 1 - cos; q in steps that grow by the
// same factor beyond 1/B, where D begins to fall.
double abcDirectionalAlbedo(const AbcLobe& lobe, int color, double n_v, int rings) {
  const double b = lobe.b, span = std::log1p(b);
  const double sin_v = std::sqrt(std::max(0.0, 1 - n_v * n_v));
  const int columns = 2 * rings;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double q = std::expm1(span * (i + 0.5) / rings) / b;
    const double dq = span / rings * (1 + b * q) / b;
    const double n_h = 1 - q, sin_h = std::sqrt(std::max(0.0, 1 - n_h * n_h));
    for (int j = 0; j < columns; ++j) {
      const double phi = 2 * M_PI * (j + 0.5) / columns;
      const double v_h = sin_v * sin_h * std::cos(phi) + n_v * n_h;
      const double n_l = 2 * v_h * n_h - n_v;
      if (v_h <= 0 || n_l <= 0) continue;
      sum += abcExact(lobe, color, n_h, n_l, n_v, v_h) * n_l * 4 * v_h * dq;
    }
  }
  return sum * 2 * M_PI / columns;
}

// GGX falls to half at cos^2 = 1 - t with (1 - (1 - a^2) (1 - t))^2 = 2 a^4, so
// a^2 = t / (sqrt(2) - 1 + t); its f at normal incidence is f0 / (4 pi a^2), the lobe's F A / pi.
GgxEquivalent nearestGgx(const AbcLobe& lobe) {
  const double q = std::min(0.5, (std::exp2(1.0 / lobe.c) - 1) / lobe.b);
  const double t = 1 - (1 - q) * (1 - q);
  const double a2 = t / (std::sqrt(2.0) - 1 + t);
  GgxEquivalent ggx;
  ggx.alpha = static_cast<float>(std::sqrt(a2));
  for (std::size_t c = 0; c < 3; ++c)
    ggx.f0[c] = static_cast<float>(
        std::min(1.0, 4 * a2 * double{lobe.a[c]} * dielectricFresnel(1, lobe.ior)));
  return ggx;
}

}  // namespace patina::brdf
