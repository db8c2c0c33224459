// SPDX-License-Identifier: GPL-3.0-or-later
// Where a specimen lies, and how it has warped: what a bump and drying do to it.
#pragma once

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// A texel of the specimen at (x, y) lies at R(turn) (x s(x), y) + moved in the rig's frame, where
// s(x) = 1 - shrunk (1 - (x / half)^2 / 3): across the grain, most in the middle, with half of the
// specimen's width; and cupped by shrunk * half / 4 * (x / half)^2 mm. The identity by default.
struct SpecimenPose {
  double moved_x_mm = 0, moved_y_mm = 0, turned_deg = 0;
  double shrunk = 0;  // share, below 0.5

  bool operator==(const SpecimenPose&) const = default;
  bool isAtHome() const { return *this == SpecimenPose{}; }
};

// Places of the specimen under the places of a grid of the rig.
SampleGrid onSpecimen(const SampleGrid& grid, const SpecimenPose& pose, double width_mm);
// Normal and height of a row prepared there, as they stand in the rig.
void poseRow(const SampleGrid& on_specimen, int y, const SpecimenPose& pose, double width_mm,
             SurfaceRow& row);

}  // namespace patina::devices::twin
