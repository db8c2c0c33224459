// SPDX-License-Identifier: GPL-3.0-or-later
// ArUco markers whose places on the specimen's plane are known (Garrido-Jurado et al., 2014).
#pragma once

#include "calibration/lens/view.h"

namespace patina::calibration {

struct Fiducial {
  int id = 0;                 // of dictionary 4x4_50
  double x_mm = 0, y_mm = 0;  // its middle
  double turn_deg = 0;        // counterclockwise, from upright as printed
};
struct FiducialSight {
  PlaneSight plane;          // the corners of the markers found
  std::vector<int> missing;  // ids told but not seen
};
// Finds the markers in linear light (greyOf()), their corners to a fraction of a pixel. `side_mm`
// is the width of their black. Throws CalibrationError: kUsage for ids that stand twice or a side
// of nothing, kBadData when none is seen. 20 ms a megapixel.
FiducialSight findFiducials(ImageView<const float> grey, std::span<const Fiducial> fiducials,
                            double side_mm);

}  // namespace patina::calibration
