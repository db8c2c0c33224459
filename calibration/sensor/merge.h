// SPDX-License-Identifier: GPL-3.0-or-later
// Several exposures of one scene to one picture of more range, with its error.
//
//   L = sum(w x / t) / sum(w),  w = t^2 / variance(L t),  error = 1 / sqrt(sum(w))
//
// x is dark-corrected light of exposure t, variance that of the noise model at the merged light,
// not at the noisy x itself, which would favour what happens to be dark (M. Granados et al.,
// "Optimal HDR reconstruction with linear digital cameras", 2010, equation 7 and section 4.2).
#pragma once

#include <vector>

#include "calibration/failure.h"
#include "calibration/sensor/colour_filters.h"
#include "calibration/sensor/noise_model.h"
#include "processing/image/image.h"

namespace patina::calibration {

struct Exposed {
  ImageView<const float> light;         // [h][w][1 or 3], share of full scale, before flat and gain
  ImageView<const std::uint8_t> marks;  // [h][w][c], of radiance.h; saturated ones do not count
  double exposure_s = 0;
};
struct Merged {
  Image<float> light;         // [h][w][c], share of full scale a second
  Image<float> error;         // one standard deviation; infinite where nothing measured
  Image<std::uint8_t> marks;  // saturated: in every exposure; its light is the least it can be
  std::int64_t saturated = 0;
  double disagreement = 0;  // RMS of (x / t - L) over its own sigma: 1 where the model holds
};
// Throws CalibrationError(kBadData): no exposure, unequal sizes, an exposure that is not positive.
// O(samples x exposures), multi-threaded.
Merged mergeExposures(const std::vector<Exposed>& exposures, const ColourFilters& filters,
                      const NoiseModels& noise);

}  // namespace patina::calibration
