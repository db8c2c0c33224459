// SPDX-License-Identifier: GPL-3.0-or-later
// A lens from pictures of a board, by OpenCV's calibrateCamera: Zhang 2000 for the start, all
// numbers together by Levenberg-Marquardt after it.
#pragma once

#include <string>

#include "calibration/lens/board.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct LensOptions {
  int radial_terms = 3;        // k1, k2, k3: 0 to 3; those left out are 0
  bool tangential = true;      // p1, p2
  bool square_pixels = false;  // fx = fy
  void check() const;
};
struct LensView {
  double rms_px = 0;       // between corners seen and corners predicted
  double tilt_deg = 0;     // of the board against the picture's plane
  double distance_mm = 0;  // of its middle, along the view
};
struct LensReport {
  int corners = 0;
  double rms_px = 0;
  std::vector<LensView> views;  // as given
  Lens sd;             // one standard deviation of every number (0: held); its size is not set
  double covered = 0;  // share of the picture within the corners' hull
  double covered_radius =
      0;                // outermost corner, in half diagonals: beyond it distortion is a guess
  double turn_deg = 0;  // largest angle between two boards
};
struct LensFit {
  Lens lens;
  LensReport report;
};

// Needs at least 3 sights, turned against one another by 10 degrees or more: with boards that are
// all parallel no focal length is better than another. Throws CalibrationError(kBadData), which
// says what to shoot. O(corners x 30); cannot be stopped half-way. The same result for any number
// of threads.
LensFit fitLens(std::span<const BoardSight> sights, SizePx size, const LensOptions& options,
                Progress& progress);

}  // namespace patina::calibration
