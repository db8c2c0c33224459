// SPDX-License-Identifier: GPL-3.0-or-later
// Where a near lamp stands and how its light falls off: from highlights on spheres at several
// places, or from the shading of a white or grey target under Lambert's law.
//
//   E(x) = k (n . u) / d^2 * cos^m(beta),   d = |p - x|, u = (p - x) / d
//
// p the lamp's place, beta the angle from its axis, which points to `aim_mm`; m = 0 shines to all
// sides. Frame: the rig's, x right, y up, z to the camera, mm. Uncertainties are one sigma, from
// the residuals. O(points) an iteration; needs no thread.
#pragma once

#include <array>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct NearLight {
  std::array<double, 3> position_mm{}, sigma_mm{};
  std::array<double, 3> aim_mm{};
  double strength = 0;       // k, in units of what was measured times mm^2; of rays: 0
  double beam_exponent = 0;  // m
  double beam_exponent_sigma = 0;
  double residual_rms = 0;  // of rays: degrees; of shading: relative
  int points = 0;
};
// What falls on a surface of normal `normal` at `at_mm`; 0 behind the surface or the cone.
double irradiance(const NearLight& light, const std::array<double, 3>& at_mm,
                  const std::array<double, 3>& normal);

// From where a highlight lies to the lamp.
struct LightRay {
  std::array<double, 3> from_mm{}, direction{};  // unit
  double sigma_deg = 0.2;
};
// The place that lies nearest to all rays, by angle. Throws CalibrationError(kBadData) for fewer
// than two rays, or rays so parallel that the distance is unknown to half of itself.
NearLight positionFromRays(const std::vector<LightRay>& rays);

struct ShadedPoint {
  std::array<double, 3> at_mm{}, normal{0, 0, 1};
  double level = 0;  // linear, > 0; flat field and ambient light undone
};
struct ShadingOptions {
  bool beam = false;               // m is unknown too; else 0
  std::array<double, 3> aim_mm{};  // where the lamp points
  double residual_most = 0.02;     // relative RMS: more is no shading of one near lamp, (0, 1)
  double uncertainty_most = 0.2;   // sigma over distance: more is refused, (0, 1)
  void check() const;              // throws CalibrationError(kUsage)
};
// Levenberg and Marquardt on the logarithm, from many starts (Marquardt 1963). Throws
// CalibrationError(kBadData): fewer than 12 points, a level that is not above 0, shading that no
// near lamp gives, a lamp too far away to be placed.
NearLight positionFromShading(const std::vector<ShadedPoint>& points, const ShadingOptions& options,
                              Progress& progress);

}  // namespace patina::calibration
