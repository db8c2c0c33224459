// SPDX-License-Identifier: GPL-3.0-or-later
// The error of what is made of light by steps that mix pixels: interpolation of colours, a lens
// straightened, a registration. Such steps correlate neighbours, and a second one must not take
// them for independent; so noise of the known variance is sent through all of them.
#pragma once

#include <cstdint>
#include <functional>

#include "calibration/failure.h"
#include "processing/image/image.h"

namespace patina::calibration {

using LightSteps = std::function<Image<float>(ImageView<const float>)>;
struct ProbeOptions {
  int probes = 32;  // 2 to 4096; a variance is known to sqrt(2 / probes) of itself
  std::uint64_t seed = 1;
  void check() const;  // CalibrationError(kUsage)
};
// Variance of steps(light) where `light`, [h][w][c], has independent errors of this variance. Of
// the steps' size; NaN where they give NaN. Deterministic. O(probes x steps).
Image<float> varianceThrough(const LightSteps& steps, ImageView<const float> light,
                             ImageView<const float> variance, const ProbeOptions& options = {});

}  // namespace patina::calibration
