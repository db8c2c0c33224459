// SPDX-License-Identifier: GPL-3.0-or-later
// Directions in the frame of a surface: x right, y up, z to the camera.
#pragma once

#include <cmath>

namespace patina::brdf {

struct Vec3 {
  float x = 0, y = 0, z = 1;
};

inline float dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3 operator*(const Vec3& v, float by) { return {v.x * by, v.y * by, v.z * by}; }
inline Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(const Vec3& v) { return std::sqrt(dot(v, v)); }
inline Vec3 normalized(const Vec3& v) {
  const float s = 1.0f / length(v);
  return {v.x * s, v.y * s, v.z * s};
}
inline Vec3 halfway(const Vec3& l, const Vec3& v) {
  return normalized({l.x + v.x, l.y + v.y, l.z + v.z});
}

}  // namespace patina::brdf
