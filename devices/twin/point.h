// SPDX-License-Identifier: GPL-3.0-or-later
// Points and directions of the rig's frame, in mm and in double: geometry is worked out once.
#pragma once

#include <array>
#include <cmath>

namespace patina::devices::twin {

struct Point {
  double x = 0, y = 0, z = 0;

  Point() = default;
  bool operator==(const Point&) const = default;
  Point(double x_, double y_, double z_) : x(x_), y(y_), z(z_) {}
  Point(const std::array<double, 3>& p) : x(p[0]), y(p[1]), z(p[2]) {}  // NOLINT: as files have it
};

inline Point operator+(const Point& a, const Point& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(const Point& a, const Point& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(double s, const Point& a) { return {s * a.x, s * a.y, s * a.z}; }
inline double dot(const Point& a, const Point& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
inline Point cross(const Point& a, const Point& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(const Point& a) { return std::sqrt(dot(a, a)); }
inline Point unit(const Point& a) { return (1 / norm(a)) * a; }

constexpr double radians(double degrees) { return degrees * M_PI / 180; }

}  // namespace patina::devices::twin
