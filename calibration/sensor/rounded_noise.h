// SPDX-License-Identifier: GPL-3.0-or-later
// Noise below one step of a converter. There the law of 1/12 fails (EMVA Standard 1288, 6.3: below
// 0.24 steps^2), so it is solved from what rounding makes of a Gaussian. Pure; microseconds.
#pragma once

namespace patina::calibration {

// Mean and variance of round(N(mean, sigma)), in steps: what a converter makes of a Gaussian.
struct RoundedMoments {
  double mean = 0, variance = 0;
};
RoundedMoments roundedMoments(double mean, double sigma);
// The temporal sigma behind numbers of this mean, this variance over all pixels of one picture and
// this half variance of the difference of two; in steps.
double sigmaBehindRounding(double mean, double variance, double half_difference_variance);

}  // namespace patina::calibration
