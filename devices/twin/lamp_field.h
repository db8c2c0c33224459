// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp as places of the scene see it: near, with a cone, of some size.
#pragma once

#include <vector>

#include "devices/twin/camera_view.h"
#include "devices/twin/point.h"

namespace patina::devices::twin {

struct LampPlace {
  Point position_mm{0, 0, 500};
  Point aim_mm;           // where the middle of its cone points
  double beam_deg = 0;    // full angle at which half of it is left: cos^n of the angle from its
                          // axis; 0: it shines to all sides
  double radius_mm = 10;  // of what shines: how soft its shadows are

  bool operator==(const LampPlace&) const = default;
};

// Light across its rays at a point, over that on a horizontal card at the origin: inverse square
// and cone. Powers are chosen so that every lamp alone gives level 1 there, whatever its distance;
// its place shapes the rest. 0 behind its cone.
double lightAcross(const LampPlace& lamp, const Point& at);
// The same on a horizontal plane through the point.
double relativeIrradiance(const LampPlace& lamp, const Point& at);

// One row of pixels under a lamp, [w] each.
struct LampRow {
  const float* irradiance;                   // lightAcross
  const float *light_x, *light_y, *light_z;  // unit direction to the lamp
  const float *half_x, *half_y, *half_z;     // halfway to the camera
  const float* fresnel;                      // Schlick's weight (1 - v.h)^5
};

// Immutable. Kept, it takes 32 bytes a pixel; not kept, rows are worked out when asked for, the
// same to the bit.
class LampField {
 public:
  LampField(const CameraView& view, const LampPlace& place, bool kept);
  // `scratch` holds the row of a field that is not kept, until the next call with it.
  LampRow row(int y, std::vector<float>& scratch) const;

 private:
  void fill(int y, float* to, std::size_t stride) const;

  const CameraView& view_;
  LampPlace place_;
  std::vector<float> kept_;  // 8 planes of [h][w]
};

}  // namespace patina::devices::twin
