// SPDX-License-Identifier: GPL-3.0-or-later
// Absolute diffuse albedo from grey or white targets of known reflectance.
//
// A target that lies in the specimen's plane gets the same light as the specimen would there, so
//
//   albedo(x, c) = s_c frame(x, c) / field(x, c),   s_c = rho_c / mean of frame / field on it
//
// with the lamp's field (gain_field.h) for light that is uneven. Lambert's law: gloss counts as
// albedo, so keep the lamp off the mirror angle. Frames are linear, without black and ambient.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

struct AlbedoTarget {
  RectPx rect_px;                              // well inside it
  std::array<double, 3> reflectance{1, 1, 1};  // of each channel, (0, 1]
};
struct AlbedoOptions {
  double level_least = 0.01;    // of a target, share of full scale
  double level_most = 0.98;     // where channels begin to clip
  double spread_most = 0.05;    // RMS within a target over its mean, noise included: more is a
                                // soiled or shaded target
  double deviance_most = 0.03;  // of several targets from the one scale
  void check() const;           // throws CalibrationError(kUsage)
};
struct AlbedoScale {
  int channels = 0;
  std::array<double, 3> scale{};     // s_c
  std::array<double, 3> sigma{};     // relative, of the texels' noise
  std::array<double, 3> deviance{};  // largest relative distance of a target from the scale
};
// Throws CalibrationError(kBadData): a rectangle beside the picture, dark, clipped or uneven
// targets, targets that contradict one another. O(targets).
AlbedoScale solveAlbedo(ImageView<const float> frame, std::optional<ImageView<const float>> field,
                        std::span<const AlbedoTarget> targets, const AlbedoOptions& options);
// frame * s / field in place. Rows in parallel.
void toAlbedo(ImageView<float> frame, std::optional<ImageView<const float>> field,
              const AlbedoScale& scale);

}  // namespace patina::calibration
