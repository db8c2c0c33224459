// SPDX-License-Identifier: GPL-3.0-or-later
// What each roughness costs a texel, as a pool of alike texels counts it. Only the fit includes
// this.
#pragma once

#include <array>

#include "processing/brdf/fit_maps.h"

namespace patina::brdf {

// By roughness, at the places of lanes::curveLogR().
using Curve = std::array<float, lanes::kCurve>;
const Curve& logRs();
inline float logR(std::size_t j) { return logRs()[j]; }
// By ln r, through each entry and its neighbours; so flat that the cubics rise and fall where the
// entries do: the wall of costs beside a wide lobe's valley is no reason for a deeper one before
// it.
Curve slopesOf(const Curve& cost);

// Between entries j and j + 1, `h` of ln r apart: the cubic of their costs and slopes. t: [0,1].
class Cubic {
 public:
  Cubic(const Curve& cost, const Curve& slope, std::size_t j);
  float h() const { return h_; }
  float at(float t) const { return p0_ + t * (m0_ + t * (c2_ + t * c3_)); }
  bool leadsDown() const { return m0_ < 0 && m1_ > 0; }  // from both entries
  float lowest() const;                                  // where, then

 private:
  float h_, p0_, m0_, m1_, c2_, c3_;
};

// A pool's texels share one roughness, from which each may be 4 % off, and the least costly of
// them need not be like the others at all. From a texel's own costs to those of the pool's
// roughness: 1 / (1 / cost + 1 / (distance from the least / 4 %)^2), which is exact where costs are
// a parabola, and never above kMostSay. How far they fall by that is told by `held`, the costs with
// the strength within what materials are: a texel that hardly tells its roughness costs as much
// everywhere then, whereas with a strength of its own it has valleys that mean nothing.
constexpr float kLeastSpread2 = 0.04f * 0.04f, kMostSay = 12;
void ofLikeTexels(Curve& own, const Curve& held, const Curve& held_slopes);

// Keeps lane k's costs at (x, y): of the roughness of alike texels, and of the one strength that
// they share, within 12 % of its own. `spread2`: of its residuals.
void keepCurve(FitState& state, const MultiLightOptions& options, const lanes::CostCurve& curve,
               float spread2, int x, int y, int k);

}  // namespace patina::brdf
