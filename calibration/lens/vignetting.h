// SPDX-License-Identifier: GPL-3.0-or-later
// Vignetting: how a lens loses light towards the corners, v(r) = 1 + a1 r^2 + a2 r^4 + a3 r^6, r in
// half diagonals from the middle of the picture. Used where a lens has no flat.
//
// From one picture of an even surface, or from several shots of one surface at different places of
// the picture, whose own light cancels out (Goldman and Chen, "Vignette and exposure calibration
// and compensation", 2005, section 3, with an even polynomial for their equation 2).
#pragma once

#include <span>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct Vignetting {
  double a1 = 0, a2 = 0, a3 = 0;
  double at(double r) const { return 1 + r * r * (a1 + r * r * (a2 + r * r * a3)); }
};
struct VignettingOptions {
  int terms = 3;  // 1 to 3: a1, a2, a3
  void check() const;
};
struct VignettingReport {
  std::int64_t samples = 0,
               left_out = 0;  // left out: beyond 4 sigma, below 2 % or above 98 % of full scale
  double rms = 0;             // share of the level
  double radius_covered = 0;  // outermost sample, half diagonals
  double corner = 1;          // v(1)
  double slope = 0;  // of one picture: change of the light from side to side, share of the mean
};
struct VignettingFit {
  Vignetting vignetting;
  VignettingReport report;
};

// From a flat, [h][w][c], linear; channels are averaged. A slope of the light across the surface is
// fitted beside it and left out. O(pixels), in blocks of 1/64 of the width.
VignettingFit vignettingOfFlat(ImageView<const float> flat, const VignettingOptions& options,
                               Progress& progress);

// One place of a surface in one shot, the light on the surface being the same in all shots.
struct SurfaceSample {
  int place = 0;      // of the surface; any numbers
  double radius = 0;  // in the picture, half diagonals
  double level = 0;   // linear, above 0
};
// Needs places seen at radii that differ by 0.2 at least. Least squares in shares of the level.
VignettingFit vignettingOfShots(std::span<const SurfaceSample> samples,
                                const VignettingOptions& options);

double radiusAt(SizePx size, double x_px, double y_px);  // half diagonals
// Divides a picture by v, in place. O(pixels).
void removeVignetting(ImageView<float> picture, const Vignetting& vignetting);

}  // namespace patina::calibration
