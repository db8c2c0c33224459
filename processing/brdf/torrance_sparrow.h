// SPDX-License-Identifier: GPL-3.0-or-later
// The simplified Torrance-Sparrow lobe of the STAF database [1/sr] (Gu et al. 2006; Meister et al.
// 2021, eqs 1 and 2), l, v, h as in ggx.h:
//
//   f = Ks exp(-(sin(h) / s)^2) / (4 (n.l) (n.v)),   Ks* = Ks pi s^2 (1 - exp(-1 / s^2))
//
// sin(h): of the angle between h and n, the tangent-plane part of h. Meister's eq. 2 prints h.n,
// with which the lobe would be smallest at the mirror direction; with the sine, eq. 9 is exact. Ks*
// (eq. 9) is the strength without the Gaussian's width, in [0,1]: what sets and fits hold.
// It gains energy at grazing angles, where no shadowing bounds it.
#pragma once

#include <cmath>

#include "processing/brdf/abc.h"
#include "processing/brdf/lobe.h"

namespace patina::brdf {

// Ks* / Ks: the projected area of exp(-(sin/s)^2) over the hemisphere.
inline float torranceSparrowNorm(float sigma) {
  const float s2 = sigma * sigma;
  return kPi * s2 * (1.0f - exp2Inline(std::max(-1.44269504f / s2, -120.0f)));
}

// Ks* = 1.
inline Lobe torranceSparrowLobe(const LobeCosines& c, float sigma) {
  const float s2 = sigma * sigma, sin2 = 1.0f - c.n_h * c.n_h;
  const float e = exp2Inline(std::max(-1.44269504f * sin2 / s2, -120.0f));
  const float rim = exp2Inline(std::max(-1.44269504f / s2, -120.0f));  // left at the horizon
  const float norm = kPi * s2 * (1.0f - rim);
  const float f = e * 0.25f / (c.n_l * c.n_v * norm + 1e-20f);
  const float norm_by_log = 2.0f * kPi * (s2 * (1.0f - rim) - rim);
  return {f, -f / c.n_l, -f / c.n_v, f * 2.0f * c.n_h / s2,
          f * (2.0f * sin2 / s2 - norm_by_log / norm)};
}

}  // namespace patina::brdf
