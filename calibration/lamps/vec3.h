// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room: arithmetic of directions and places.
#pragma once

#include <array>
#include <cmath>

namespace patina::calibration {

using Vec3 = std::array<double, 3>;

inline double dot(const Vec3& a, const Vec3& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
inline double norm(const Vec3& a) { return std::sqrt(dot(a, a)); }
inline Vec3 sum(const Vec3& a, const Vec3& b, double times = 1) {  // a + times b
  return {a[0] + times * b[0], a[1] + times * b[1], a[2] + times * b[2]};
}
inline Vec3 times(const Vec3& a, double by) { return {a[0] * by, a[1] * by, a[2] * by}; }
inline Vec3 unit(const Vec3& a) { return times(a, 1 / norm(a)); }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace patina::calibration
