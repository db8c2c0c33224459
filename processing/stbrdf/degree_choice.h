// SPDX-License-Identifier: GPL-3.0-or-later
// Which degree the samples ask for: leave-one-out cross-validation in closed form. The error at a
// step that the fit has not seen is the residual over (1 - leverage), for every degree from one
// orthonormal basis of the times.
#pragma once

#include <span>
#include <vector>

#include "processing/stbrdf/samples.h"

namespace patina::stbrdf {

struct DegreeRow {
  int degree = 0;
  double fit_rms = 0;       // of the fit's own samples
  double left_out_rms = 0;  // of samples that the fit has not seen; 1 = a map's whole range
};

struct DegreeChoice {
  int degree = 0;               // the lowest whose left_out_rms is within 2 % of the least
  std::vector<DegreeRow> rows;  // from degree 0 on
  // A fit of `degree` tells more of noise than of the process: some lower one predicts better by
  // more than 10 %, or there is no row for it, since it passes through its samples.
  bool overfits(int degree) const;
};

// Over all maps, each at most 20,000 series spread evenly. Degrees up to 12 and to the number of
// different times less 2. Throws ProcessingError(kUsage) for fewer than 2 different times.
DegreeChoice chooseDegree(std::span<const TimeSamples> maps, std::span<const double> weights);

}  // namespace patina::stbrdf
