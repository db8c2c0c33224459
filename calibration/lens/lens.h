// SPDX-License-Identifier: GPL-3.0-or-later
// A lens as a pinhole with distortion, the model of OpenCV and of every tool that reads its files:
//
//   x = X/Z, y = Y/Z, r^2 = x^2 + y^2,  radial = 1 + k1 r^2 + k2 r^4 + k3 r^6
//   u = fx (x radial + 2 p1 x y + p2 (r^2 + 2 x^2)) + cx
//   v = fy (y radial + p1 (r^2 + 2 y^2) + 2 p2 x y) + cy
//
// X right, Y down, Z along the view; u and v in pixels, whole numbers at pixel centres.
// D. C. Brown, "Decentering distortion of lenses", 1966; Z. Zhang, "A flexible new technique for
// camera calibration", 2000.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "calibration/failure.h"
#include "calibration/place.h"
#include "processing/image/image.h"

namespace patina::calibration {

struct PointMm {
  double x = 0, y = 0, z = 0;
};

struct Lens {
  SizePx size;                                    // of the pictures it holds for
  double fx = 0, fy = 0, cx = 0, cy = 0;          // px
  double k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0;  // radii in focal lengths
  void check() const;  // CalibrationError(kBadData): no camera has such numbers
};

std::array<double, 9> matrixOf(const Lens& lens);      // 3x3, by rows
std::array<double, 5> distortionOf(const Lens& lens);  // k1 k2 p1 p2 k3

// Where a lens without distortion, of the same focal length, would see the same points, in pixels.
// Iterates to 1e-7 px. O(points).
std::vector<PlacePx> undistorted(const Lens& lens, std::span<const PlacePx> seen);
// The other way round. Exact. Beyond the picture the polynomial may fold back: ask only for what
// undistorted() gives of the picture, or a little around it.
std::vector<PlacePx> distorted(const Lens& lens, std::span<const PlacePx> straight);

// The largest radius in focal lengths, undistorted, that a pixel of the picture sees.
double widestRadius(const Lens& lens);

}  // namespace patina::calibration
