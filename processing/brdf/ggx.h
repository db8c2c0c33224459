// SPDX-License-Identifier: GPL-3.0-or-later
// Microfacet reflectance with the GGX distribution: f = D V F [1/sr], V = G2 / (4 (n.l) (n.v)).
//
//   D(h) = a^2 / (pi ((n.h)^2 (a^2 - 1) + 1)^2)          Walter et al. 2007, eq. 33
//   G2   = height-correlated Smith masking-shadowing       Heitz 2014, eq. 99
//   F    = f0 + (1 - f0) (1 - v.h)^5                       Schlick 1994, eq. 15
//
// a: roughness alpha in (0,1] (not its square root, the "perceptual" roughness); f0: reflectance at
// normal incidence in [0,1]; n, l, v, h: unit vectors, h halfway between l and v. Single
// scattering: energy is lost at high roughness, never gained. Cosines are clamped at zero by the
// caller. Inline and free of branches: loops over texels vectorise.
#pragma once

#include <cmath>

#include "processing/brdf/lambert.h"
#include "processing/brdf/lobe.h"
#include "processing/brdf/vector.h"

namespace patina::brdf {

inline float ggxDistribution(float n_h, float alpha) {
  const float a2 = alpha * alpha;
  const float q = n_h * n_h * (a2 - 1.0f) + 1.0f;
  return a2 * kInversePi / (q * q);
}

inline float smithVisibility(float n_l, float n_v, float alpha) {
  const float a2 = alpha * alpha, rest = 1.0f - a2;
  const float lv = n_v * std::sqrt(n_l * n_l * rest + a2);
  const float ll = n_l * std::sqrt(n_v * n_v * rest + a2);
  return 0.5f / (lv + ll + 1e-20f);
}

// (1 - v.h)^5; F = f0 + (1 - f0) * this.
inline float schlickWeight(float v_h) {
  const float m = 1.0f - v_h, m2 = m * m;
  return m2 * m2 * m;
}
inline float schlickFresnel(float f0, float v_h) { return f0 + (1.0f - f0) * schlickWeight(v_h); }

// D V with its derivatives; F is left out.
inline Lobe ggxLobe(const LobeCosines& c, float alpha) {
  const float a2 = alpha * alpha, rest = 1.0f - a2, nh2 = c.n_h * c.n_h;
  const float q = 1.0f - nh2 * rest, inverse_q = 1.0f / q;
  const float root_l = std::sqrt(c.n_l * c.n_l * rest + a2);
  const float root_v = std::sqrt(c.n_v * c.n_v * rest + a2);
  const float inverse_s = 1.0f / (c.n_v * root_l + c.n_l * root_v + 1e-20f);
  const float f = a2 * kInversePi * inverse_q * inverse_q * 0.5f * inverse_s;
  const float to_l = c.n_l / root_l, to_v = c.n_v / root_v;
  const float s_by_l = c.n_v * rest * to_l + root_v, s_by_v = c.n_l * rest * to_v + root_l;
  const float s_by_a2 =
      0.5f * (c.n_v * (1.0f - c.n_l * c.n_l) / root_l + c.n_l * (1.0f - c.n_v * c.n_v) / root_v);
  return {f, -f * inverse_s * s_by_l, -f * inverse_s * s_by_v, f * 4.0f * rest * c.n_h * inverse_q,
          2.0f * alpha * f * (1.0f / a2 - 2.0f * nh2 * inverse_q - inverse_s * s_by_a2)};
}

// Zero when l or v is below the surface.
float ggx(const Vec3& n, const Vec3& l, const Vec3& v, float f0, float alpha);

// The share of light from direction v that leaves into the hemisphere: the integral of f cos over
// l, by the midpoint rule with `rings` x 2 `rings` cells, stretched towards the mirror direction
// by sampling half vectors. At most 1 for every f0 and alpha. O(rings^2).
float ggxDirectionalAlbedo(float n_v, float f0, float alpha, int rings = 128);

}  // namespace patina::brdf
