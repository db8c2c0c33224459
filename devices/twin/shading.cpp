// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/shading.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"
#include "processing/brdf/ggx.h"

namespace patina::devices::twin {

namespace {

using S = SurfaceRow;

// The channels of a row's even and odd pixels.
struct Pick {
  const float *diffuse_even, *diffuse_odd, *specular_even, *specular_odd;
};

Pick channels(const SurfaceRow& row, int even, int odd) {
  const auto at = [&](int first, int c) { return row[static_cast<S::Channel>(first + c)]; };
  return {at(S::kDiffuseR, even), at(S::kDiffuseR, odd), at(S::kSpecularR, even),
          at(S::kSpecularR, odd)};
}

// Of the RGGB mosaic: even and odd pixels of row y.
int evenChannel(int y) { return y % 2; }
int oddChannel(int y) { return y % 2 + 1; }

template <bool kDistant>
float viewCosine(const ShadedRow& row, int x, float nx, float ny, float nz) {
  if (kDistant) return std::max(nz, 0.0f);
  return std::max(nx * row.view.x[x] + ny * row.view.y[x] + nz * row.view.z[x], 0.0f);
}

template <bool kDistant>
void shade(const ShadedRow& row, const Pick& pick, float* out) {
  const float *nx = row.surface[S::kNormalX], *ny = row.surface[S::kNormalY],
              *nz = row.surface[S::kNormalZ], *alpha = row.surface[S::kRoughness];
  const float *d_even = pick.diffuse_even, *d_odd = pick.diffuse_odd, *s_even = pick.specular_even,
              *s_odd = pick.specular_odd;
  const LampRow lamp = row.lamp;
  const int width = row.surface.width();
  PATINA_INDEPENDENT_TEXELS
  for (int x = 0; x < width; ++x) {
    const float n_l =
        std::max(nx[x] * lamp.light_x[x] + ny[x] * lamp.light_y[x] + nz[x] * lamp.light_z[x], 0.0f);
    const float n_h =
        std::max(nx[x] * lamp.half_x[x] + ny[x] * lamp.half_y[x] + nz[x] * lamp.half_z[x], 0.0f);
    const float n_v = viewCosine<kDistant>(row, x, nx[x], ny[x], nz[x]);
    const float lobe =
        brdf::ggxDistribution(n_h, alpha[x]) * brdf::smithVisibility(n_l, n_v, alpha[x]);
    const float d0 = d_even[x], d1 = d_odd[x], s0 = s_even[x], s1 = s_odd[x];
    const float diffuse = (x & 1) ? d1 : d0, f0 = (x & 1) ? s1 : s0;
    // Times pi: a perfect white diffuser reflects 1, not 1 / pi.
    const float fresnel = f0 + (1 - f0) * lamp.fresnel[x];
    out[x] = (diffuse + brdf::kPi * lobe * fresnel) * n_l * lamp.irradiance[x];
  }
}

// Strengths of the measured lobes for even and odd pixels.
struct Strengths {
  float fresh_even, fresh_odd, aged_even, aged_odd;
};

template <bool kDistant>
void shadeMeasured(const ShadedRow& row, const Pick& pick, const Strengths& a, float* out) {
  const float *nx = row.surface[S::kNormalX], *ny = row.surface[S::kNormalY],
              *nz = row.surface[S::kNormalZ], *degree = row.surface[S::kDegree];
  const float *d_even = pick.diffuse_even, *d_odd = pick.diffuse_odd;
  const LampRow lamp = row.lamp;
  const brdf::AbcLobe fresh = row.measured->fresh, aged = row.measured->aged;
  const int width = row.surface.width();
  PATINA_INDEPENDENT_TEXELS
  for (int x = 0; x < width; ++x) {
    const float hx = lamp.half_x[x], hy = lamp.half_y[x], hz = lamp.half_z[x];
    const float n_l =
        std::max(nx[x] * lamp.light_x[x] + ny[x] * lamp.light_y[x] + nz[x] * lamp.light_z[x], 0.0f);
    const float n_h = std::max(nx[x] * hx + ny[x] * hy + nz[x] * hz, 0.0f);
    const float n_v = viewCosine<kDistant>(row, x, nx[x], ny[x], nz[x]);
    const float v_h = viewCosine<kDistant>(row, x, hx, hy, hz);
    const float young = brdf::abcShape(fresh, n_h, n_l, n_v, v_h) * (1 - degree[x]),
                old = brdf::abcShape(aged, n_h, n_l, n_v, v_h) * degree[x];
    const float even = a.fresh_even * young + a.aged_even * old,
                odd = a.fresh_odd * young + a.aged_odd * old;
    const float d0 = d_even[x], d1 = d_odd[x];
    const float diffuse = (x & 1) ? d1 : d0, lobe = (x & 1) ? odd : even;
    out[x] = (diffuse + brdf::kPi * lobe) * n_l * lamp.irradiance[x];
  }
}

void shadeRow(const ShadedRow& row, int even, int odd, float* out) {
  const Pick pick = channels(row.surface, even, odd);
  if (row.measured) {
    const auto &young = row.measured->fresh.a, &old = row.measured->aged.a;
    const Strengths a{young[even], young[odd], old[even], old[odd]};
    row.view.x ? shadeMeasured<false>(row, pick, a, out) : shadeMeasured<true>(row, pick, a, out);
  } else {
    row.view.x ? shade<false>(row, pick, out) : shade<true>(row, pick, out);
  }
  if (!row.visibility) return;
  const int width = row.surface.width();
  for (int x = 0; x < width; ++x) out[x] *= row.visibility[x];
}

void addSkyRow(const SurfaceRow& surface, int even_channel, int odd_channel, float level,
               float* out) {
  const Pick pick = channels(surface, even_channel, odd_channel);
  const float *d_even = pick.diffuse_even, *d_odd = pick.diffuse_odd, *s_even = pick.specular_even,
              *s_odd = pick.specular_odd, *nz = surface[S::kNormalZ];
  const int width = surface.width();
  PATINA_INDEPENDENT_TEXELS
  for (int x = 0; x < width; ++x) {
    const float even = d_even[x] + s_even[x], odd = d_odd[x] + s_odd[x];
    out[x] += level * ((x & 1) ? odd : even) * (1 + nz[x]) * 0.5f;
  }
}

}  // namespace

void shadeMosaicRow(const ShadedRow& row, int y, float* out) {
  shadeRow(row, evenChannel(y), oddChannel(y), out);
}

void shadeChannelRow(const ShadedRow& row, int channel, float* out) {
  shadeRow(row, channel, channel, out);
}

void shadeCardRow(const LampRow& lamp, int width, float* out) {
  for (int x = 0; x < width; ++x) out[x] = lamp.irradiance[x] * std::max(lamp.light_z[x], 0.0f);
}

void addSkyMosaicRow(const SurfaceRow& surface, int y, float level, float* out) {
  addSkyRow(surface, evenChannel(y), oddChannel(y), level, out);
}

void addSkyChannelRow(const SurfaceRow& surface, int channel, float level, float* out) {
  addSkyRow(surface, channel, channel, level, out);
}

}  // namespace patina::devices::twin
