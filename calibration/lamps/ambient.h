// SPDX-License-Identifier: GPL-3.0-or-later
// Light that is not the lamps', taken away by a picture with all of them off.
#pragma once

#include <array>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

struct AmbientOptions {
  double exposure_ratio = 1;  // of the frame over the lights-off picture, > 0
  double saturated = 0.98;    // level from which the lights-off picture says nothing, (0, 1]
  double share_most = 0.5;    // of the frame's light: more is refused, (0, 1]
  // Of the sensor, for the noise: variance = level * noise_per_level + read_noise^2, of full scale.
  double noise_per_level = 0, read_noise = 0;
  void check() const;  // throws CalibrationError(kUsage)
};
struct AmbientReport {
  std::array<double, 3> share{};  // of each channel's light that was ambient
  double saturated_share = 0;     // of the lights-off picture's samples
  // Noise after over noise before, RMS over the picture: sqrt(1 + ratio^2 var(off) / var(frame));
  // 1 where no noise model is given.
  double noise_factor = 1;
};
// frame -= ratio * off, in place; not clamped at 0, so that the mean stays true. Both linear and
// free of black. Throws CalibrationError(kBadData): another size, a clipped lights-off picture,
// more ambient light than share_most. Rows in parallel.
AmbientReport subtractAmbient(ImageView<float> frame, ImageView<const float> off,
                              const AmbientOptions& options);

}  // namespace patina::calibration
