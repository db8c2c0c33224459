// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/optics.h"

#include <algorithm>
#include <cmath>

#include "devices/twin/row_loop.h"
#include "processing/brdf/ggx.h"

namespace patina::devices::twin {

namespace {

// r_u of r_d, by Newton's method: exact to float after four steps for any lens a camera has.
double undistorted(double r_d, const LensProfile& lens) {
  double r = r_d;
  for (int i = 0; i < 6; ++i) {
    const double r2 = r * r;
    const double value = r * (1 + lens.k1 * r2 + lens.k2 * r2 * r2) - r_d;
    r -= value / (1 + 3 * lens.k1 * r2 + 5 * lens.k2 * r2 * r2);
  }
  return r;
}

}  // namespace

SampleGrid lensGrid(SizePx size, const LensProfile& lens, double width_mm) {
  SampleGrid grid;
  grid.size = size;
  const auto count = static_cast<std::size_t>(size.width) * size.height;
  grid.x_mm.resize(count);
  grid.y_mm.resize(count);
  const double focal_px = lens.focal_length * size.width;
  const double corner = std::hypot(size.width, size.height) / 2 / focal_px;
  const double mm = width_mm / size.width * corner / undistorted(corner, lens);
  grid.texel_mm = static_cast<float>(mm);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = x + 0.5 - size.width * 0.5, dy = size.height * 0.5 - y - 0.5;
      const double r_d = std::hypot(dx, dy) / focal_px;
      const double stretch = r_d > 0 ? undistorted(r_d, lens) / r_d : 1;
      grid.x_mm[grid.index(x, y)] = static_cast<float>(dx * stretch * mm);
      grid.y_mm[grid.index(x, y)] = static_cast<float>(dy * stretch * mm);
    }
  return grid;
}

std::vector<float> lensFalloff(SizePx size, const LensProfile& lens) {
  std::vector<float> falloff(static_cast<std::size_t>(size.width) * size.height);
  const double corner2 = (static_cast<double>(size.width) * size.width +
                          static_cast<double>(size.height) * size.height) /
                         4;
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const double dx = x + 0.5 - size.width * 0.5, dy = y + 0.5 - size.height * 0.5;
      falloff[static_cast<std::size_t>(y) * size.width + x] =
          static_cast<float>(1 - lens.corner_falloff * (dx * dx + dy * dy) / corner2);
    }
  return falloff;
}

LampField lampField(const SampleGrid& grid, const std::array<double, 3>& lamp_mm) {
  const std::size_t n = grid.x_mm.size();
  LampField f;
  for (auto* v : {&f.irradiance, &f.light_x, &f.light_y, &f.light_z, &f.half_x, &f.half_y,
                  &f.half_z, &f.fresnel})
    v->resize(n);
  const double d0_2 = lamp_mm[0] * lamp_mm[0] + lamp_mm[1] * lamp_mm[1] + lamp_mm[2] * lamp_mm[2];
  const double cos0 = lamp_mm[2] / std::sqrt(d0_2);
  for (std::size_t k = 0; k < n; ++k) {
    const double dx = lamp_mm[0] - grid.x_mm[k], dy = lamp_mm[1] - grid.y_mm[k], dz = lamp_mm[2];
    const double d2 = dx * dx + dy * dy + dz * dz, d = std::sqrt(d2);
    const brdf::Vec3 l{static_cast<float>(dx / d), static_cast<float>(dy / d),
                       static_cast<float>(dz / d)};
    const brdf::Vec3 h = brdf::halfway(l, {0, 0, 1});
    f.irradiance[k] = static_cast<float>(d0_2 / d2 / cos0);
    f.light_x[k] = l.x;
    f.light_y[k] = l.y;
    f.light_z[k] = l.z;
    f.half_x[k] = h.x;
    f.half_y[k] = h.y;
    f.half_z[k] = h.z;
    f.fresnel[k] = brdf::schlickWeight(h.z);
  }
  return f;
}

void shadeMosaicRow(const SurfaceRow& surface, const LampField& lamp, int y, float* out) {
  using S = SurfaceRow;
  const bool red_row = y % 2 == 0;
  const float *d_even = surface[red_row ? S::kDiffuseR : S::kDiffuseG],
              *d_odd = surface[red_row ? S::kDiffuseG : S::kDiffuseB],
              *s_even = surface[red_row ? S::kSpecularR : S::kSpecularG],
              *s_odd = surface[red_row ? S::kSpecularG : S::kSpecularB];
  const float *nx = surface[S::kNormalX], *ny = surface[S::kNormalY], *nz = surface[S::kNormalZ],
              *alpha = surface[S::kRoughness];
  const std::size_t at = static_cast<std::size_t>(y) * surface.width();
  const float *e = &lamp.irradiance[at], *lx = &lamp.light_x[at], *ly = &lamp.light_y[at],
              *lz = &lamp.light_z[at], *hx = &lamp.half_x[at], *hy = &lamp.half_y[at],
              *hz = &lamp.half_z[at], *weight = &lamp.fresnel[at];
  const int width = surface.width();
  PATINA_INDEPENDENT_TEXELS
  for (int x = 0; x < width; ++x) {
    const float n_l = std::max(nx[x] * lx[x] + ny[x] * ly[x] + nz[x] * lz[x], 0.0f);
    const float n_h = std::max(nx[x] * hx[x] + ny[x] * hy[x] + nz[x] * hz[x], 0.0f);
    const float lobe = brdf::ggxDistribution(n_h, alpha[x]) *
                       brdf::smithVisibility(n_l, std::max(nz[x], 0.0f), alpha[x]);
    const float d0 = d_even[x], d1 = d_odd[x], s0 = s_even[x], s1 = s_odd[x];
    const float diffuse = (x & 1) ? d1 : d0, f0 = (x & 1) ? s1 : s0;
    // Times pi: a perfect white diffuser reflects 1, not 1 / pi.
    const float fresnel = f0 + (1 - f0) * weight[x];
    out[x] = (diffuse + brdf::kPi * lobe * fresnel) * n_l * e[x];
  }
}

void shadeCardRow(const LampField& lamp, int y, int width, float* out) {
  const std::size_t at = static_cast<std::size_t>(y) * width;
  for (int x = 0; x < width; ++x) out[x] = lamp.irradiance[at + x] * lamp.light_z[at + x];
}

int patchBorderPx(const RectPx& patch) {
  return std::max(1, std::min(patch.width, patch.height) / 16);
}

}  // namespace patina::devices::twin
