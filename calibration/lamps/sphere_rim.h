// SPDX-License-Identifier: GPL-3.0-or-later
// Where a mirror sphere lies in a picture, and the normal of every texel of it.
//
// Seen from afar its rim is a circle. A pinhole camera sees it as an ellipse: the rays that touch a
// sphere form a cone, so all unit rays d of the rim have d.a = cos(theta), which is linear in
// a/cos(theta) and needs no ellipse.
//
// Frame of the camera: x right, y up, z to the camera. Places in pixels, texel centres at halves.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

// What is known of the camera, as plain numbers of its calibration.
struct SphereCamera {
  bool pinhole = false;     // else so far away that all rays are parallel
  double focal_px = 0;      // of a pinhole, and of any camera with distortion
  double centre_x_px = -1;  // principal point; below 0: the picture's middle
  double centre_y_px = -1;
  double k1 = 0, k2 = 0;               // radial distortion (Brown 1966), radius in focal lengths
  void check(const SizePx& of) const;  // throws CalibrationError(kUsage)
};

// A circle in the picture, as a person would draw it.
struct Disc {
  double x_px = 0, y_px = 0, radius_px = 0;
};

struct RimReport {
  int points = 0;           // of the rim that were used
  double inlier_share = 0;  // of the directions in which a rim was looked for
  double rms_px = 0;        // distance of the used points from the rim fitted
  bool given = false;       // by a person: nothing was looked for
};

// Immutable.
class MirrorSphere {
 public:
  struct Touch {
    std::array<double, 3> normal, view;  // unit; view points to the camera
  };
  const Disc& disc() const { return disc_; }
  const RimReport& report() const { return report_; }
  // What a place in the picture sees of the sphere; nothing beside it.
  std::optional<Touch> touchAt(double x_px, double y_px) const;
  // The middle of the sphere in the camera's frame in units of its radius, of a pinhole camera:
  // there it tells how far away the sphere is.
  std::array<double, 3> middle() const { return middle_; }
  // The same sphere in the picture that was shrunk by `by` before it was found.
  MirrorSphere enlarged(int by) const;

 private:
  friend MirrorSphere sphereAt(const Disc&, SizePx, const SphereCamera&);
  friend MirrorSphere findSphere(ImageView<const float>, const SphereCamera&);
  MirrorSphere(SizePx size, const SphereCamera& camera);
  std::array<double, 2> straight(double x_px, double y_px) const;  // focal lengths or pixels
  std::array<double, 3> rayTo(double x_px, double y_px) const;
  void fit(const std::vector<std::array<double, 2>>& rim);  // least squares
  double residualPx(const std::array<double, 2>& at) const;

  SphereCamera camera_;
  Disc disc_;
  RimReport report_;
  double x_ = 0, y_ = 0, radius_ = 0;        // of parallel rays: the circle, straightened
  std::array<double, 3> axis_{}, middle_{};  // of a pinhole
  double cosine_ = 0, sine_ = 0;             // of the cone
};

// Both throw CalibrationError(kBadData) when the sphere is cut off by the frame.
MirrorSphere sphereAt(const Disc& disc, SizePx picture, const SphereCamera& camera);
// `steady`: [h][w][1], what does not change with the light (the median over all shots), in which a
// sphere is a disc with an edge all round. Throws when there is none. O(pixels).
MirrorSphere findSphere(ImageView<const float> steady, const SphereCamera& camera);

}  // namespace patina::calibration
