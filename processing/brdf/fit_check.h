// SPDX-License-Identifier: GPL-3.0-or-later
// What the fit of many lights refuses, and why, in words. Only the fit includes this.
#pragma once

#include <vector>

#include "processing/brdf/multi_light_fit.h"

namespace patina::brdf {

// Throws ProcessingError(kBadData) as fitManyLights() says.
void checkSamples(const std::vector<FitSample>& samples, const MultiLightOptions& options,
                  const std::vector<FitBefore>& before);

}  // namespace patina::brdf
