// SPDX-License-Identifier: GPL-3.0-or-later
// Sixteen texels under many lights, as the fit's inner loops see them.
#pragma once

#include "processing/brdf/fit_lanes.h"
#include "processing/brdf/ggx.h"
#include "tests/processing/brdf/lit_maps.h"

namespace patina::brdf::lanes {

// GGX of kd, ks, r; texel k's normal leans to the right by k hundredths.
struct Planted {
  float kd = 0.4f, ks = 0.1f, r = 0.25f;
};
inline Estimate truthOf(const Planted& planted) {
  Estimate truth;
  for (int k = 0; k < kLanes; ++k) {
    const Vec3 n = normalized({0.01f * static_cast<float>(k), 0.05f, 1});
    truth.nx[k] = n.x, truth.ny[k] = n.y, truth.nz[k] = n.z;
    truth.u[k] = std::log(planted.r);
    truth.kd[k] = planted.kd;
    truth.ks[k] = planted.ks;
  }
  return truth;
}
inline Samples plant(const Planted& planted, int lights = 24) {
  const std::vector<SurfaceLight> from = dome(lights);
  const Estimate truth = truthOf(planted);
  Samples s(from.size());
  for (std::size_t i = 0; i < from.size(); ++i) {
    s.light[i].view = {0, 0, 1};
    const LightRay ray = rayAt(from[i], s.light[i].view, 0, 0);
    for (int k = 0; k < kLanes; ++k) {
      const Vec3 n{truth.nx[k], truth.ny[k], truth.nz[k]};
      s.light[i].lx[k] = ray.l.x, s.light[i].ly[k] = ray.l.y, s.light[i].lz[k] = ray.l.z;
      s.light[i].hx[k] = ray.h.x, s.light[i].hy[k] = ray.h.y, s.light[i].hz[k] = ray.h.z;
      s.light[i].v_h[k] = ray.v_h;
      s.light[i].half[k] = 0.5f / ray.v_h;
      s.light[i].m[k] = schlickWeight(ray.v_h);
      s.light[i].e[k] = 1;
      s.light[i].noise[k] = s.light[i].weight[k] = 1e6f;
      s.light[i].y[k] = (planted.kd + kPi * ggx(n, ray.l, s.light[i].view, planted.ks, planted.r)) *
                        std::max(dot(n, ray.l), 0.0f);
    }
  }
  return s;
}
inline Prior noPrior() { return {}; }

}  // namespace patina::brdf::lanes
