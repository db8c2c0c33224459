// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/camera_view.h"

#include <algorithm>
#include <cmath>

#include "processing/image/failure.h"

namespace patina::devices::twin {

namespace {

constexpr double kAfarMm = 1e6;

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

CameraView::CameraView(SizePx size, const LensProfile& lens, const CameraPose& pose,
                       double width_mm)
    : lens_(lens), pose_(pose) {
  ground_.size = size;
  const auto count = static_cast<std::size_t>(size.width) * size.height;
  ground_.x_mm.resize(count);
  ground_.y_mm.resize(count);
  if (pose.distant) {
    focal_px_ = lens.focal_length * size.width;
    seeFromAfar(width_mm);
  } else {
    focal_px_ = pose.focal_widths * size.width;
    seeFrom(pose);
  }
}

// Columns and rows turn with the camera; the scene stays.
void CameraView::seeFromAfar(double width_mm) {
  const SizePx size = ground_.size;
  const double corner = std::hypot(size.width, size.height) / 2 / focal_px_;
  mm_per_px_ = width_mm / size.width * corner / undistorted(corner, lens_);
  ground_.texel_mm = static_cast<float>(mm_per_px_);
  const double turn = radians(pose_.roll_deg);
  right_ = {std::cos(turn), std::sin(turn), 0};
  up_ = {-std::sin(turn), std::cos(turn), 0};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Point seen = ray(x + 0.5, y + 0.5).origin;
      ground_.x_mm[ground_.index(x, y)] = static_cast<float>(seen.x);
      ground_.y_mm[ground_.index(x, y)] = static_cast<float>(seen.y);
    }
}

void CameraView::seeFrom(const CameraPose& pose) {
  const SizePx size = ground_.size;
  pose_.position_mm = pose.position_mm + pose.moved_mm;
  forward_ = pose.look_at_mm - pose.position_mm;
  if (!(norm(forward_) > 0))
    throw ProcessingError(Exit::kConfig, "a camera that looks at where it stands");
  forward_ = unit(forward_);
  const Point upward = std::abs(forward_.y) < 0.999 ? Point{0, 1, 0} : Point{0, 0, 1};
  const Point level = unit(cross(forward_, upward)), above = cross(level, forward_);
  const double turn = radians(pose.roll_deg), c = std::cos(turn), s = std::sin(turn);
  right_ = c * level + s * above;
  up_ = c * above - s * level;
  const auto count = static_cast<std::size_t>(size.width) * size.height;
  for (auto* v : {&to_x_, &to_y_, &to_z_}) v->resize(count);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const Ray r = ray(x + 0.5, y + 0.5);
      const double length = -r.origin.z / r.direction.z;
      if (!(length > 0) || !(r.origin.z > 0))
        throw ProcessingError(Exit::kConfig,
                              "a pixel does not see the specimen's plane from above");
      const std::size_t k = ground_.index(x, y);
      const Point seen = r.origin + length * r.direction;
      ground_.x_mm[k] = static_cast<float>(seen.x);
      ground_.y_mm[k] = static_cast<float>(seen.y);
      to_x_[k] = static_cast<float>(-r.direction.x);
      to_y_[k] = static_cast<float>(-r.direction.y);
      to_z_[k] = static_cast<float>(-r.direction.z);
    }
  const std::size_t a = ground_.index(size.width / 2 - 1, size.height / 2 - 1),
                    b = ground_.index(size.width / 2, size.height / 2);
  ground_.texel_mm =
      std::hypot(ground_.x_mm[b] - ground_.x_mm[a], ground_.y_mm[b] - ground_.y_mm[a]) *
      static_cast<float>(M_SQRT1_2);
}

Ray CameraView::ray(double x_px, double y_px) const {
  const double dx = x_px - ground_.size.width * 0.5, dy = ground_.size.height * 0.5 - y_px;
  const double r_d = std::hypot(dx, dy) / focal_px_;
  const double stretch = r_d > 0 ? undistorted(r_d, lens_) / r_d : 1;
  if (pose_.distant) {
    const double mm = stretch * mm_per_px_;
    return {pose_.moved_mm + (dx * mm) * right_ + (dy * mm) * up_ + Point{0, 0, kAfarMm},
            {0, 0, -1}};
  }
  const double share = stretch / focal_px_;
  return {pose_.position_mm, unit(forward_ + (dx * share) * right_ + (dy * share) * up_)};
}

ViewRow CameraView::viewRow(int y) const {
  if (to_x_.empty()) return {};
  const std::size_t k = ground_.index(0, y);
  return {&to_x_[k], &to_y_[k], &to_z_[k]};
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

}  // namespace patina::devices::twin
