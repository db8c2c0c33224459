// SPDX-License-Identifier: GPL-3.0-or-later
// How far lights tell a texel's gloss: variances out of the normal equations.
#include <algorithm>
#include <cmath>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

constexpr double kSpecularSigma = 0.014, kRoughnessSigma = 0.021;

// What kd and ks take out of the nonlinear equations: the inverse of their 2x2 matrix between the
// rows of two nonlinear parameters.
struct Linear {
  double iaa, iab, ibb;
  Linear(double aa, double ab, double bb, bool has_d) {
    const double det = aa * bb - ab * ab;
    iaa = has_d ? bb / det : 0;
    iab = has_d ? -ab / det : 0;
    ibb = has_d ? aa / det : 1 / bb;
  }
  double between(double a1, double g1, double a2, double g2) const {
    return iaa * a1 * a2 + iab * (a1 * g2 + a2 * g1) + ibb * g1 * g2;
  }
};

struct Variances {
  double specular = HUGE_VAL, u = HUGE_VAL;
  double slope = 0;  // -d ks / d ln r, kd and the normal's part as they fit best then
};
// With `ks_weight` of the prior of ks taken off again.
Variances variancesOf(const Estimate& at, const Equations& q, double ks_weight, int k) {
  const double aa = q.aa[k], ab = q.ab[k], held_bb = q.bb[k], bb = held_bb - ks_weight;
  if (!(aa * bb - ab * ab > 1e-6 * aa * bb) || !(bb > 0)) return {};
  const bool has_d = at.kd[k] > 0;
  const Linear held(aa, ab, held_bb, has_d), own(aa, ab, bb, has_d);
  const double a1 = q.a1[k], a2 = q.a2[k], au = q.au[k], g1 = q.g1[k], g2 = q.g2[k], gu = q.gu[k];
  const auto freed = [&](double h, double ax, double gx, double ay, double gy) {
    return h + held.between(ax, gx, ay, gy) - own.between(ax, gx, ay, gy);
  };
  const double h11 = freed(q.h11[k], a1, g1, a1, g1), h12 = freed(q.h12[k], a1, g1, a2, g2),
               h22 = freed(q.h22[k], a2, g2, a2, g2), h1u = freed(q.h1u[k], a1, g1, au, gu),
               h2u = freed(q.h2u[k], a2, g2, au, gu), huu = freed(q.huu[k], au, gu, au, gu);
  const double c11 = h22 * huu - h2u * h2u, c12 = h1u * h2u - h12 * huu,
               c1u = h12 * h2u - h22 * h1u, c22 = h11 * huu - h1u * h1u,
               c2u = h12 * h1u - h11 * h2u, cuu = h11 * h22 - h12 * h12;
  const double det = h11 * c11 + h12 * c12 + h1u * c1u;
  if (!(det > 0) || !(cuu > 0)) return {};
  const double k1 = own.iab * a1 + own.ibb * g1, k2 = own.iab * a2 + own.ibb * g2,
               ku = own.iab * au + own.ibb * gu;
  return {own.ibb + (k1 * k1 * c11 + k2 * k2 * c22 + ku * ku * cuu +
                     2 * (k1 * k2 * c12 + k1 * ku * c1u + k2 * ku * c2u)) /
                        det,
          cuu / det, ku};
}

}  // namespace

Certainty certaintyOf(const Estimate& at, const Equations& q, const Prior& prior, double spread2,
                      int k) {
  if (!(at.ks[k] > 0)) return {};
  const Variances own = variancesOf(at, q, prior.ks_weight[k], k), all = variancesOf(at, q, 0, k);
  const double var_r = std::exp(2.0 * at.u[k]) * all.u * spread2;
  // Neighbours' specular strengths have the roughness of one pool: what it is off by, all of them
  // are off by together, however many they are.
  const double specular = std::max(all.specular, own.slope * own.slope * own.u);
  const double off = specular * spread2 / (kSpecularSigma * kSpecularSigma) +
                     var_r / (kRoughnessSigma * kRoughnessSigma);
  Certainty certainty;
  certainty.confidence = off >= 0 ? 1 / (1 + off) : 0;
  certainty.specular_weight = own.specular > 0 ? 1 / (own.specular * spread2) : 0;
  return certainty;
}

}  // namespace patina::brdf::lanes
