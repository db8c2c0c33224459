// SPDX-License-Identifier: GPL-3.0-or-later
// How a camera sees the scene: its lens, its pose, and where every pixel meets the specimen.
//
// Pixels are distorted radially: r_d = r_u (1 + k1 r_u^2 + k2 r_u^4), radii in focal lengths (Brown
// 1966). Relief enters shading and shadows, not the projection: pixels see the plane z = 0.
#pragma once

#include <vector>

#include "devices/twin/point.h"
#include "devices/twin/profile.h"
#include "devices/twin/specimen.h"

namespace patina::devices::twin {

struct CameraPose {
  // A distant camera looks straight down from so far away that all rays are parallel; the corners
  // of its picture see the corners of the specimen's rectangle.
  bool distant = true;
  Point position_mm{0, 0, 500}, look_at_mm;  // else a pinhole here, looking there, the rig's y up
  double roll_deg = 0;                       // about its own axis, counterclockwise
  double focal_widths = 1.2;                 // focal length over the width of the picture
  Point moved_mm;                            // by a bump, along the plane

  bool operator==(const CameraPose&) const = default;
};

struct Ray {
  Point origin, direction;  // unit
};

// Unit directions to the camera of one row's pixels; null of a distant camera: (0, 0, 1).
struct ViewRow {
  const float *x = nullptr, *y = nullptr, *z = nullptr;
};

// Immutable after construction. O(pixels) to make.
class CameraView {
 public:
  // Throws ProcessingError(kConfig) when a pixel does not see the plane from above.
  CameraView(SizePx size, const LensProfile& lens, const CameraPose& pose, double width_mm);
  // The view of surfaceAt(): no lens, straight down.
  explicit CameraView(SampleGrid ground) : ground_(std::move(ground)) {}

  SizePx size() const { return ground_.size; }
  const SampleGrid& ground() const { return ground_; }
  ViewRow viewRow(int y) const;
  // Through a place in the picture: pixel centres at halves, y down. Not of a view without lens.
  Ray ray(double x_px, double y_px) const;

 private:
  void seeFromAfar(double width_mm);
  void seeFrom(const CameraPose& pose);

  SampleGrid ground_;
  LensProfile lens_;
  CameraPose pose_;
  double focal_px_ = 1, mm_per_px_ = 1;  // the latter of a distant camera, undistorted
  Point right_{1, 0, 0}, up_{0, 1, 0}, forward_{0, 0, -1};
  std::vector<float> to_x_, to_y_, to_z_;
};

// Share of the light that reaches a pixel: 1 in the middle, falling with the radius squared.
std::vector<float> lensFalloff(SizePx size, const LensProfile& lens);

}  // namespace patina::devices::twin
