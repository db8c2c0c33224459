// SPDX-License-Identifier: GPL-3.0-or-later
// Do light directions belong to these pictures? Mirrored axes, two lights exchanged, z turned away.
//
// Lambert's normals fit mirrored directions as well as true ones, so the fit alone says nothing.
// Three things tell:
//   - Normals of a surface are free of curl: dp/dy = dq/dx. One mirrored axis turns the sign of one
//     side: `parity` is the correlation of the two, near -1 .. 0 .. 1 (Frankot and Chellappa 1988).
//   - What is near a lamp, or faces it, is brighter: the slope of a picture's brightness goes with
//     its light's x and y (`slope_x`, `slope_y`, correlations over the pictures).
//   - Each picture is best explained by its own light.
// A bowl or a vault that fills the picture turns the second sign; parity does not mind.
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct LightFileOptions {
  double sure_sigma = 4;       // of a correlation, from which it counts, > 0
  double better_least = 0.55;  // misfit by another's light over that by its own, below which they
                               // were exchanged, (0, 1)
  void check() const;          // throws CalibrationError(kUsage)
};
enum class Mirroring { kNone, kX, kY, kXY, kOneOfXY, kUnclear };
struct LightFileCheck {
  Mirroring mirroring = Mirroring::kUnclear;
  double parity = 0, slope_x = 0, slope_y = 0;                    // correlations
  double parity_sigma = 0, slope_x_sigma = 0, slope_y_sigma = 0;  // how many sigma from 0
  int behind = 0;                                                 // lights with z <= 0
  std::vector<std::pair<int, int>> exchanged;                     // pairs of pictures
  std::vector<double> misfit;  // of each picture by its own light, 0 to 1
  bool fits() const;           // nothing speaks against the file
};
// `pictures`: [h][w][1] linear, one a light, of one size, at most some 300 texels a side
// (reducedGrey; fitting is O(texels lights)). Throws CalibrationError(kBadData): another count than
// directions, fewer than 4, sizes that differ, a direction of no length.
LightFileCheck checkLightFile(std::span<const ImageView<const float>> pictures,
                              std::span<const std::array<double, 3>> directions,
                              const LightFileOptions& options, Progress& progress);
// In words: "x is mirrored: turn the sign of every x".
std::string sentence(const LightFileCheck& check);

}  // namespace patina::calibration
