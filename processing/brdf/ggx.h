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

// What the lobe of a texel seen from one side has together under all lights; a2 = alpha^2.
struct GgxTexel {
  float n_v, a2, rest, root_v, inverse_root_v;  // rest = 1 - a2
  float strength, leant, half_n_v, half_off;    // products of those
};
inline GgxTexel ggxTexel(float n_v, float alpha) {
  const float a2 = alpha * alpha, rest = 1.0f - a2, root_v = std::sqrt(n_v * n_v * rest + a2);
  const float inverse = 1.0f / root_v;
  return {n_v,        a2,         rest,
          root_v,     inverse,    0.5f * kInversePi * a2,
          n_v * rest, 0.5f * n_v, 0.5f * (1.0f - n_v * n_v) * inverse};
}
// What takes long of a light: a root, and the one division that all that is divided by shares.
struct GgxLight {
  float root_l, inverse;
};
inline GgxLight ggxLight(const GgxTexel& t, float n_l, float n_h) {
  const float root_l = std::sqrt(n_l * n_l * t.rest + t.a2);
  const float s = t.n_v * root_l + n_l * t.root_v, q = 1.0f - n_h * n_h * t.rest;
  return {root_l, 1.0f / (q * s * root_l)};
}

// D V with its derivatives; F is left out.
inline Lobe ggxLobe(const GgxTexel& t, const GgxLight& l, float n_l, float n_h) {
  const float nh2 = n_h * n_h, q = 1.0f - nh2 * t.rest;
  const float s = t.n_v * l.root_l + n_l * t.root_v, inverse_qs = l.inverse * l.root_l;
  const float inverse_root_l = l.inverse * (q * s), inverse_q = inverse_qs * s,
              inverse_s = inverse_qs * q;
  const float f = t.strength * inverse_q * inverse_qs, fs = -f * inverse_s;
  const float both = t.leant * n_l, four = 4.0f * inverse_q;
  const float by_a2 = t.half_n_v * (1.0f - n_l * n_l) * inverse_root_l + n_l * t.half_off;
  return {f, fs * (both * inverse_root_l + t.root_v), fs * (both * t.inverse_root_v + l.root_l),
          f * t.rest * (n_h * four), f * (2.0f - t.a2 * (nh2 * four + 2.0f * (inverse_s * by_a2)))};
}
inline Lobe ggxLobe(const LobeCosines& c, float alpha) {
  const GgxTexel texel = ggxTexel(c.n_v, alpha);
  return ggxLobe(texel, ggxLight(texel, c.n_l, c.n_h), c.n_l, c.n_h);
}

// Zero when l or v is below the surface.
float ggx(const Vec3& n, const Vec3& l, const Vec3& v, float f0, float alpha);

// The share of light from direction v that leaves into the hemisphere: the integral of f cos over
// l, by the midpoint rule with `rings` x 2 `rings` cells, stretched towards the mirror direction
// by sampling half vectors. At most 1 for every f0 and alpha. O(rings^2).
float ggxDirectionalAlbedo(float n_v, float f0, float alpha, int rings = 128);

}  // namespace patina::brdf
