// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/delta_e.h"

#include <algorithm>
#include <cmath>

namespace patina::calibration {
namespace {

constexpr double kTurn = 2 * M_PI;

double radiansOf(double degrees) { return degrees * M_PI / 180; }
double seventh(double c) {
  const double c3 = c * c * c;
  return c3 * c3 * c;
}
// sqrt(C^7 / (C^7 + 25^7))
double chromaShare(double c) {
  const double c7 = seventh(c);
  return std::sqrt(c7 / (c7 + seventh(25)));
}

double hueOf(double a, double b) {
  if (a == 0 && b == 0) return 0;
  const double h = std::atan2(b, a);
  return h < 0 ? h + kTurn : h;
}

// Equation (14); of colours without hue the sum is the hue of the other.
double meanHue(double h1, double h2, bool without_hue) {
  if (without_hue) return h1 + h2;
  if (std::abs(h1 - h2) <= M_PI) return (h1 + h2) / 2;
  return h1 + h2 < kTurn ? (h1 + h2 + kTurn) / 2 : (h1 + h2 - kTurn) / 2;
}

// Equation (10).
double hueStep(double h1, double h2) {
  const double step = h2 - h1;
  if (step > M_PI) return step - kTurn;
  return step < -M_PI ? step + kTurn : step;
}

}  // namespace

std::array<double, 3> deltaE2000Parts(const Lab& one, const Lab& two) {
  const double g =
      0.5 * (1 - chromaShare((std::hypot(one.a, one.b) + std::hypot(two.a, two.b)) / 2));
  const double a1 = (1 + g) * one.a, a2 = (1 + g) * two.a;
  const double c1 = std::hypot(a1, one.b), c2 = std::hypot(a2, two.b);
  const double h1 = hueOf(a1, one.b), h2 = hueOf(a2, two.b);
  const bool without_hue = c1 * c2 == 0;
  const double hue = 2 * std::sqrt(c1 * c2) * std::sin((without_hue ? 0 : hueStep(h1, h2)) / 2);

  const double l = (one.l + two.l) / 2, c = (c1 + c2) / 2, h = meanHue(h1, h2, without_hue);
  const double t = 1 - 0.17 * std::cos(h - radiansOf(30)) + 0.24 * std::cos(2 * h) +
                   0.32 * std::cos(3 * h + radiansOf(6)) - 0.20 * std::cos(4 * h - radiansOf(63));
  const double off_blue = (h - radiansOf(275)) / radiansOf(25);
  const double rotation = radiansOf(30) * std::exp(-off_blue * off_blue);
  const double r_t = -std::sin(2 * rotation) * 2 * chromaShare(c);
  const double l50 = (l - 50) * (l - 50);
  const double s_l = 1 + 0.015 * l50 / std::sqrt(20 + l50);

  const double lightness = (two.l - one.l) / s_l;
  const double chroma = (c2 - c1) / (1 + 0.045 * c);
  const double turned = hue / (1 + 0.015 * c * t);
  return {lightness, chroma + r_t / 2 * turned,
          std::sqrt(std::max(0.0, 1 - r_t * r_t / 4)) * turned};
}

double deltaE2000(const Lab& a, const Lab& b) {
  const auto [l, c, h] = deltaE2000Parts(a, b);
  return std::sqrt(l * l + c * c + h * h);
}

}  // namespace patina::calibration
