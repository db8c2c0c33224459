// SPDX-License-Identifier: GPL-3.0-or-later
// What is to be thought of a texel's fit. Only the fit includes this.
#pragma once

#include <algorithm>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {

// Over the levels that count.
struct LaneFit {
  int used = 0;
  double square = 0, chi2 = 0;
  double lamps = 0;  // share of the noise's variance that is the lamps'
  double misfit(int parameters) const { return chi2 / std::max(used - parameters, 1); }
  double spread2(int parameters) const { return std::max(1.0, misfit(parameters)); }
};
// Of lane k, whose lobes have just been found; `lamp_noise`: FitNoise's gain.
LaneFit fitOf(const Samples& samples, const Estimate& at, float lamp_noise, int k);

// Whether shadows hide what lane k is: it comes out darker than any material, or an edge halves the
// pixel alike under most lamps, so that the few that reach all of it are brighter than predicted,
// which no shadow is.
bool isSpoilt(const Samples& samples, const Estimate& at, int k);

}  // namespace patina::brdf::lanes
