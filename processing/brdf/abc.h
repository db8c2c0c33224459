// SPDX-License-Identifier: GPL-3.0-or-later
// The ABC microfacet model of measured gloss: f = F D G / (pi (n.l) (n.v)) [1/sr].
//
//   D(h) = A / (1 + B (1 - n.h))^C                       Löw et al. 2012, sec. 4: not normalised
//   G    = min(1, 2 (n.h)(n.l) / (v.h), 2 (n.h)(n.v) / (v.h))      Cook and Torrance 1982, eq. 7
//   F    = unpolarised Fresnel reflectance of a dielectric of index `ior`
//
// A per colour, B and C and ior for all: the form of the published fits to the materials of the
// MERL data base (J. Dupuy's dj_brdf, public domain), whose diffuse part is Lambert's. n, l, v, h:
// unit vectors, h halfway between l and v; cosines are clamped at zero by the caller. Inline, free
// of branches and of calls: loops over texels vectorise, and give the same values on any machine.
// Accurate to 1e-5 of the value for B below 10,000; above, 1 - n.h in float is too coarse.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "processing/brdf/lambert.h"
#include "processing/brdf/vector.h"

namespace patina::brdf {

struct AbcLobe {
  std::array<float, 3> a{};  // strength in red, green and blue, >= 0
  float b = 1;               // above 0; the higher, the narrower
  float c = 1;               // above 0; the lower, the longer the tail
  float ior = 1.5f;          // above 1
};

// log2 of a normal number above 0, within 1e-7 + 1e-7 |log2|.
inline float log2Inline(float v) {
  const auto bits = std::bit_cast<std::int32_t>(v);
  const std::int32_t exponent = (bits - 0x3f3504f3) >> 23;  // mantissa in [sqrt(1/2), sqrt(2))
  const auto m = std::bit_cast<float>(bits - (exponent << 23));
  const float t = (m - 1.0f) / (m + 1.0f), t2 = t * t;  // ln m = 2 artanh t
  const float series = 1.0f + t2 * (1.0f / 3 + t2 * (1.0f / 5 + t2 * (1.0f / 7 + t2 / 9)));
  return static_cast<float>(exponent) + 2.88539008f * t * series;
}

// 2^v, relative error below 2e-7; v in [-126, 126].
inline float exp2Inline(float v) {
  constexpr float kToInteger = 12582912.0f;  // 1.5 * 2^23: adding it rounds to a whole number
  const float shifted = v + kToInteger;
  const std::int32_t whole = std::bit_cast<std::int32_t>(shifted) - 0x4b400000;
  const float f = (v - (shifted - kToInteger)) * 0.693147181f;  // in +-0.35
  const float e =
      1 + f * (1 + f * (1.0f / 2 + f * (1.0f / 6 + f * (1.0f / 24 + f * (1.0f / 120 + f / 720)))));
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(e) + (whole << 23));
}

// D / A.
inline float abcFalloff(const AbcLobe& lobe, float n_h) {
  return exp2Inline(-lobe.c * log2Inline(1.0f + lobe.b * std::max(1.0f - n_h, 0.0f)));
}

// G / (pi (n.l) (n.v)): finite however low the light or the view.
inline float cookTorranceVisibility(float n_h, float n_l, float n_v, float v_h) {
  const float low = std::min(n_l, n_v), high = std::max(n_l, n_v);
  const float open = 1.0f / (low * high + 1e-7f), grooved = 2.0f * n_h / (v_h * high + 1e-7f);
  return kInversePi * std::min(open, grooved);
}

inline float dielectricFresnel(float v_h, float ior) {
  const float g = std::sqrt(ior * ior - 1.0f + v_h * v_h);
  const float p = (g - v_h) / (g + v_h);
  const float q = (v_h * (g + v_h) - 1.0f) / (v_h * (g - v_h) + 1.0f);
  return 0.5f * p * p * (1.0f + q * q);
}

// f = A * this, A that of the colour.
inline float abcShape(const AbcLobe& lobe, float n_h, float n_l, float n_v, float v_h) {
  return dielectricFresnel(v_h, lobe.ior) * abcFalloff(lobe, n_h) *
         cookTorranceVisibility(n_h, n_l, n_v, v_h);
}

// f of colour 0, 1 or 2; zero when l or v is below the surface.
float abc(const AbcLobe& lobe, int color, const Vec3& n, const Vec3& l, const Vec3& v);

// The same model in double precision, by the library's functions: an independent path for tests.
double abcExact(const AbcLobe& lobe, int color, double n_h, double n_l, double n_v, double v_h);

// The share of light from direction v that leaves into the hemisphere (see ggxDirectionalAlbedo),
// in double precision. A fit may break the law of energy: ask before using one. O(rings^2).
double abcDirectionalAlbedo(const AbcLobe& lobe, int color, double n_v, int rings = 128);

// What stands for a lobe where only GGX is spoken: its f at normal incidence and the angle at
// which f has fallen to half are kept. `f0` is not the reflectance of the medium, but what makes
// the heights equal; at most 1.
struct GgxEquivalent {
  std::array<float, 3> f0{};
  float alpha = 1;
};
GgxEquivalent nearestGgx(const AbcLobe& lobe);

}  // namespace patina::brdf
