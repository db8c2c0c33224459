// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/colour_space.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

namespace patina::calibration {
namespace {

using Rows = cv::Matx33d;

Rows rowsOf(const Matrix3& m) { return Rows(m.data()); }

Matrix3 arrayOf(const Rows& m) {
  Matrix3 out;
  std::copy_n(m.val, out.size(), out.begin());
  return out;
}

cv::Vec3d vectorOf(const Xyz& c) { return {c.x, c.y, c.z}; }

constexpr double kEpsilon = 216.0 / 24389, kKappa = 24389.0 / 27;

double compressed(double t) { return t > kEpsilon ? std::cbrt(t) : (kKappa * t + 16) / 116; }
double expanded(double f) { return f > 6.0 / 29 ? f * f * f : (116 * f - 16) / kKappa; }

}  // namespace

Lab labOf(const Xyz& colour, const Xyz& white) {
  const double fx = compressed(colour.x / white.x), fy = compressed(colour.y / white.y),
               fz = compressed(colour.z / white.z);
  return {116 * fy - 16, 500 * (fx - fy), 200 * (fy - fz)};
}

Xyz xyzOf(const Lab& colour, const Xyz& white) {
  const double fy = (colour.l + 16) / 116, fx = fy + colour.a / 500, fz = fy - colour.b / 200;
  return {white.x * expanded(fx), white.y * expanded(fy), white.z * expanded(fz)};
}

std::array<double, 3> mapped(const Matrix3& m, const std::array<double, 3>& v) {
  return {m[0] * v[0] + m[1] * v[1] + m[2] * v[2], m[3] * v[0] + m[4] * v[1] + m[5] * v[2],
          m[6] * v[0] + m[7] * v[1] + m[8] * v[2]};
}

Matrix3 product(const Matrix3& a, const Matrix3& b) { return arrayOf(rowsOf(a) * rowsOf(b)); }

Matrix3 inverseOf(const Matrix3& matrix) { return arrayOf(rowsOf(matrix).inv()); }

Matrix3 bradford(const Xyz& from_white, const Xyz& to_white) {
  const Rows cones(0.8951, 0.2664, -0.1614, -0.7502, 1.7135, 0.0367, 0.0389, -0.0685, 1.0296);
  const cv::Vec3d from = cones * vectorOf(from_white), to = cones * vectorOf(to_white);
  const cv::Vec3d gain(to[0] / from[0], to[1] / from[1], to[2] / from[2]);
  return arrayOf(cones.inv() * Rows::diag(gain) * cones);
}

Matrix3 xyzFromLinearSrgb() {
  // Chromaticities (x, y) of the primaries, IEC 61966-2-1; each scaled so that all three at 1 give
  // white.
  constexpr double kPrimaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
  Rows primaries;
  for (int c = 0; c < 3; ++c) {
    const double x = kPrimaries[c][0], y = kPrimaries[c][1];
    primaries(0, c) = x / y;
    primaries(1, c) = 1;
    primaries(2, c) = (1 - x - y) / y;
  }
  const cv::Vec3d scale = primaries.inv() * vectorOf(kD65);
  return product(bradford(kD65, kD50), arrayOf(primaries * Rows::diag(scale)));
}

Matrix3 linearSrgbFromXyz() { return inverseOf(xyzFromLinearSrgb()); }

}  // namespace patina::calibration
