// SPDX-License-Identifier: GPL-3.0-or-later
// Where a camera stands over the specimen: its pose against the plane z = 0, from places on that
// plane whose millimetres are known (a board that lies on it, or ArUco markers).
#pragma once

#include "calibration/lens/board.h"

namespace patina::calibration {

// Millimetres of the plane: x right, y up, z to the camera, as in a rig file. The camera's own
// axes: x right, y down, z along the view.
struct View {
  std::array<double, 9> camera_from_plane{};  // rotation, by rows
  std::array<double, 3> plane_origin_mm{};    // in the camera's axes
};
struct PlaneSight {
  std::vector<PointMm> plane_mm;  // z = 0
  std::vector<PlacePx> seen_px;
};
struct ViewReport {
  int points = 0;
  double rms_px = 0, worst_px = 0;
  PointMm camera_mm;     // where it stands
  double tilt_deg = 0;   // of its axis against the plane's normal
  double mm_per_px = 0;  // at the middle of the picture
};
struct ViewFit {
  View view;
  ViewReport report;
};

// The board's sight as one of the plane it lies on: its middle is the origin, and the side of the
// board nearest to the picture's rows is x, towards the picture's right.
PlaneSight planeOf(const BoardSight& sight);

// Least squares over reprojections, from the planar solution of Collins and Bartoli (IPPE, 2014).
// Needs 4 points or more, not on one line. Throws CalibrationError(kBadData) also when the points
// lie further than 3 px from where the pose puts them: another board or lens than told. O(points).
ViewFit fitView(const Lens& lens, const PlaneSight& sight);

// Pixels at which the camera sees places of the plane; NaN for what lies behind it or so far
// outside of the picture that the lens is not known there.
std::vector<PlacePx> project(const Lens& lens, const View& view, std::span<const PointMm> plane_mm);
// Where pixels meet the plane; NaN above the horizon.
std::vector<PointMm> planePlaces(const Lens& lens, const View& view, std::span<const PlacePx> seen);

}  // namespace patina::calibration
