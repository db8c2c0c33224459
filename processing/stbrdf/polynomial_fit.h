// SPDX-License-Identifier: GPL-3.0-or-later
// Polynomials in time, texel by texel (Meister et al. 2021, eq. 8). Where we depart: the degree is
// chosen at run time, times are uneven and weighted, the solution comes from orthogonal polynomials
// in float64, and all texels share one small matrix, so that a fit costs one pass over the samples.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/progress.h"
#include "processing/stbrdf/samples.h"
#include "processing/stbrdf/stbrdf_set.h"

namespace patina::stbrdf {

struct FitOptions {
  int degree = 3;               // 0 to 12, below the number of different times
  std::vector<double> weights;  // of squared errors, a step; empty: all equal
  bool bounded = false;         // keep every polynomial within the map's range
};

struct FittedMap {
  TimeMap map;                      // in basisOf(degree)
  Image<float> error;               // weighted RMS over time, [h][w][channels]
  std::vector<double> rms;          // over texels and times, a channel
  std::int64_t bounded_series = 0;  // whose fit had to be bent
};

// Throws ProcessingError(kUsage) for options that cannot be, kBadData for samples that cannot.
// Memory: samples, coefficients and error. Same bytes for any number of threads and on any
// SIMD path.
FittedMap fitMap(const TimeSamples& samples, const FitOptions& options, Progress& progress);

}  // namespace patina::stbrdf
