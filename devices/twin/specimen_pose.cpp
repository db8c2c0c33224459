// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen_pose.h"

#include <cmath>

#include "devices/twin/point.h"

namespace patina::devices::twin {

namespace {

// x of the specimen that lies at `seen` when it has shrunk, by Newton's method.
double unshrunk(double seen, double shrunk, double half) {
  double x = seen;
  for (int i = 0; i < 6; ++i) {
    const double q = x / half, value = x * (1 - shrunk * (1 - q * q / 3)) - seen;
    x -= value / (1 - shrunk * (1 - q * q));
  }
  return x;
}

}  // namespace

SampleGrid onSpecimen(const SampleGrid& grid, const SpecimenPose& pose, double width_mm) {
  SampleGrid places = grid;
  if (pose.isAtHome()) return places;
  const double c = std::cos(radians(pose.turned_deg)), s = std::sin(radians(pose.turned_deg));
  for (std::size_t k = 0; k < places.x_mm.size(); ++k) {
    const double x = grid.x_mm[k] - pose.moved_x_mm, y = grid.y_mm[k] - pose.moved_y_mm;
    places.x_mm[k] = static_cast<float>(unshrunk(c * x + s * y, pose.shrunk, width_mm / 2));
    places.y_mm[k] = static_cast<float>(-s * x + c * y);
  }
  return places;
}

void poseRow(const SampleGrid& on_specimen, int y, const SpecimenPose& pose, double width_mm,
             SurfaceRow& row) {
  if (pose.isAtHome()) return;
  const auto half = static_cast<float>(width_mm / 2);
  const auto cup = static_cast<float>(pose.shrunk) * half / 4;
  const auto c = static_cast<float>(std::cos(radians(pose.turned_deg))),
             s = static_cast<float>(std::sin(radians(pose.turned_deg)));
  float *nx = row[SurfaceRow::kNormalX], *ny = row[SurfaceRow::kNormalY],
        *nz = row[SurfaceRow::kNormalZ], *height = row[SurfaceRow::kHeight];
  for (int i = 0; i < row.width(); ++i) {
    const float q = on_specimen.x_mm[on_specimen.index(i, y)] / half;
    height[i] += cup * q * q;
    const float x = nx[i] - 2 * cup * q / half * nz[i];
    const float length = std::sqrt(x * x + ny[i] * ny[i] + nz[i] * nz[i]);
    const float tilted = x / length, along = ny[i] / length;
    nx[i] = c * tilted - s * along;
    ny[i] = s * tilted + c * along;
    nz[i] /= length;
  }
}

}  // namespace patina::devices::twin
