// SPDX-License-Identifier: GPL-3.0-or-later
// Colours as CIE numbers, and the ways between them. White is Y = 1 (not 100).
#pragma once

#include <array>

namespace patina::calibration {

// Of a camera (share of full scale) or of a display: linear light.
using Rgb = std::array<double, 3>;

struct Xyz {
  double x = 0, y = 0, z = 0;
};
struct Lab {
  double l = 0, a = 0, b = 0;
};
using Matrix3 = std::array<double, 9>;  // by rows

constexpr Xyz kD50{0.96422, 1, 0.82521};  // of ICC profiles and of chart makers
constexpr Xyz kD65{0.95047, 1, 1.08883};  // of sRGB and Rec. 709

// CIE 15:2004, 8.2.1. Also of numbers below zero, which a fit may give.
Lab labOf(const Xyz& colour, const Xyz& white = kD50);
Xyz xyzOf(const Lab& colour, const Xyz& white = kD50);

std::array<double, 3> mapped(const Matrix3& matrix, const std::array<double, 3>& v);
Matrix3 product(const Matrix3& a, const Matrix3& b);
Matrix3 inverseOf(const Matrix3& matrix);

// Chromatic adaptation by Bradford's cone responses, linear (ICC.1:2010, annex E).
Matrix3 bradford(const Xyz& from_white, const Xyz& to_white);
// Linear sRGB (D65; the primaries of Rec. 709) and XYZ adapted to D50.
Matrix3 xyzFromLinearSrgb();
Matrix3 linearSrgbFromXyz();

}  // namespace patina::calibration
