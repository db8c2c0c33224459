// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces that shrink, swell or warp: a smooth field of displacements on top of a pose.
#pragma once

#include "calibration/registration/motion.h"
#include "calibration/registration/prepared_picture.h"
#include "processing/image/pixel_map.h"
#include "processing/image/progress.h"

namespace patina::calibration {

// Give a pose by an affine model: the field is held to what changes little from point to point.
struct DeformationOptions {
  int spacing_px = 32;      // of the control points, pixels of the picture (8 .. 1024)
  double smoothness = 1.0;  // weight of a point's neighbours against what it sees itself (0 .. 100)
  int iterations = 4;       // a level (1 .. 50)
  int finest_level = 0;     // 1: half of the resolution is enough (0 .. 4)
  void check() const;       // CalibrationError(kUsage): field, value, range
};

struct Deformation {
  // Where in the frame the control points of the reference are seen, beyond `frame_from_reference`:
  // dx, dy in pixels, [rows][columns][2]; point (i, j) lies at (i, j) * spacing_px.
  Image<float> beyond_px;
  int spacing_px = 0;
  Motion frame_from_reference = kNoMotion;
  SizePx size;
  double zncc_before = 0, zncc_after = 0;  // of `local` over what is usable
  double largest_px = 0;                   // displacement beyond the pose

  PlacePx moved(PlacePx place) const;  // of the reference, to the frame; bilinear between points
  PixelMap map() const;                // of the size of the reference
};

// Coarse to fine from `frame_from_reference`: at every control point a Gauss-Newton step on
// `local`, in a window of twice the spacing (Lucas and Kanade 1981), then relaxed towards its
// neighbours, the more the less it sees of its own (a membrane, as Horn and Schunck 1981, equation
// 12, on a grid). Follows up to half a window of the coarsest level. O(pixels x iterations);
// multi-threaded; the same for any number of threads.
Deformation findDeformation(const PreparedPicture& reference, const PreparedPicture& frame,
                            const Motion& frame_from_reference, const DeformationOptions& options,
                            Progress& progress);

// zncc of `local` over what is usable, the frame laid over the reference by `field`.
double agreementBy(const Deformation& field, const PreparedPicture& reference,
                   const PreparedPicture& frame, int level = 0);
double largestOf(const Image<float>& beyond_px);

}  // namespace patina::calibration
