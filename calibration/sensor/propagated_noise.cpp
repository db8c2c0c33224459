// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/propagated_noise.h"

#include <cmath>
#include <string>
#include <utility>

#include "processing/image/parallel_rows.h"
#include "processing/image/random.h"

namespace patina::calibration {

void ProbeOptions::check() const {
  if (probes < 2 || probes > 4096)
    throw CalibrationError(Exit::kUsage,
                           "noise: probes must lie in [2, 4096], not " + std::to_string(probes));
}

Image<float> varianceThrough(const LightSteps& steps, ImageView<const float> light,
                             ImageView<const float> variance, const ProbeOptions& options) {
  options.check();
  if (light.size() != variance.size() || light.channels != variance.channels)
    throw CalibrationError(Exit::kBadData, "noise: light and variance differ in size");
  const Image<float> without = steps(light);
  Image<float> sum(without.width(), without.height(), without.channels());
  Image<float> noisy(light.width, light.height, light.channels);
  for (int probe = 0; probe < options.probes; ++probe) {
    forEachRow(light.height, std::int64_t{64} * light.width * light.channels, [&](int y) {
      for (int i = 0; i < light.width * light.channels; ++i)
        noisy.view().row(y)[i] =
            light.row(y)[i] +
            std::sqrt(variance.row(y)[i]) *
                static_cast<float>(gaussian(
                    hashSeed(options.seed, static_cast<std::uint64_t>(probe),
                             static_cast<std::uint64_t>(y), static_cast<std::uint64_t>(i))));
    });
    const Image<float> with = steps(std::as_const(noisy).view());
    for (std::size_t k = 0; k < sum.texels().size(); ++k) {
      const float off = with.texels()[k] - without.texels()[k];
      sum.texels()[k] += off * off / static_cast<float>(options.probes);
    }
  }
  return sum;
}

}  // namespace patina::calibration
