// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/reflectance_bound.h"

#include <Eigen/Dense>
#include <cmath>

#include "processing/brdf/ggx.h"

namespace patina::testing {
namespace {

using Parameters = Eigen::Matrix<double, 5, 1>;  // diffuse, specular, alpha, slopes of the normal
const double kGuessed = 1 / std::sqrt(12.0);

double levelOf(const Parameters& p, const brdf::LightRay& ray) {
  const double z = 1 / std::sqrt(1 + p[3] * p[3] + p[4] * p[4]), x = p[3] * z, y = p[4] * z;
  const double n_l = ray.l.x * x + ray.l.y * y + ray.l.z * z;
  if (!(n_l > 0)) return 0;
  const double n_h = ray.h.x * x + ray.h.y * y + ray.h.z * z, n_v = z, a2 = p[2] * p[2];
  const double q = n_h * n_h * (a2 - 1) + 1, m = std::pow(1 - double{ray.v_h}, 5);
  const double v = 0.5 / (n_v * std::sqrt(n_l * n_l * (1 - a2) + a2) +
                          n_l * std::sqrt(n_v * n_v * (1 - a2) + a2));
  const double gloss = a2 / (q * q) * v * (p[1] + (1 - p[1]) * m);  // times pi: white is 1
  return ray.irradiance * n_l * (p[0] + gloss);
}

}  // namespace

ReflectanceBound boundOf(const KnownTexel& texel, const std::vector<brdf::LightRay>& rays,
                         const TexelExposure& exposure) {
  const double z = std::max(double{texel.normal.z}, 0.05);
  const Parameters at{texel.diffuse, texel.specular, texel.alpha, texel.normal.x / z,
                      texel.normal.y / z};
  Eigen::Matrix<double, 5, 5> information = Eigen::Matrix<double, 5, 5>::Zero();
  information.diagonal().head<3>().setConstant(1 / (kGuessed * kGuessed));
  for (const brdf::LightRay& ray : rays) {
    const double level = levelOf(at, ray);
    if (level * exposure.white_e > exposure.full_well_e) continue;
    Parameters slope;
    for (int i = 0; i < 5; ++i) {
      Parameters up = at, down = at;
      up[i] += 1e-4, down[i] -= 1e-4;
      slope[i] = (levelOf(up, ray) - levelOf(down, ray)) / 2e-4;
    }
    const double variance =
        (level * exposure.white_e + exposure.read_noise_e * exposure.read_noise_e) /
        (exposure.white_e * exposure.white_e * exposure.pixels);
    information += slope * slope.transpose() / variance;
  }
  information.diagonal().tail<2>().array() += 1e-9;
  const Eigen::Matrix<double, 5, 5> variance = information.inverse();
  return {std::sqrt(variance(0, 0)), std::sqrt(variance(1, 1)), std::sqrt(variance(2, 2))};
}

}  // namespace patina::testing
