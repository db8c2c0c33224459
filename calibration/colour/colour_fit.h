// SPDX-License-Identifier: GPL-3.0-or-later
// Which model brings a chart's fields nearest to what they are.
//
// Least squares in XYZ give the start; Levenberg and Marquardt's method then goes down on the sum
// of squared deltaE 2000. The error of fields that a fit has not seen (each left out in turn)
// chooses among the kinds, for 24 fields do not hold up 39 numbers by themselves: the one of fewest
// numbers within 5 % of the least.
#pragma once

#include "calibration/colour/colour_model.h"
#include "calibration/colour/plain_matrix.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct FitOptions {
  std::optional<FitKind> kind{};  // nothing: chosen by fields left out
  bool preserve_white = false;    // the white field comes out exactly
  int iterations_max = 60;        // in [0, 1000]; 0: XYZ alone
  void check() const;
};

struct FieldColours {
  Lab expected, before, after;  // before: white-balanced numbers taken for linear sRGB
  double delta_e_before = 0, delta_e_after = 0;
};
struct KindError {
  FitKind kind = FitKind::k3x3;
  double mean = 0, left_out_mean = 0;  // deltaE 2000 of fields in the fit, and left out of it
};
struct ColourFitReport {
  std::array<FieldColours, kChartFields> fields;
  double mean_before = 0, worst_before = 0;
  double mean_after = 0, median_after = 0, worst_after = 0;
  int worst_field = 0;           // after
  double left_out_mean = 0;      // of the kind taken
  std::vector<KindError> kinds;  // that were tried
  int iterations = 0;            // of the kind taken
};
struct ColourFit {
  ColourModel model;
  ColourFitReport report;
};
// Throws CalibrationError(kBadData) when the fields do not determine the model (all alike, or not
// finite). About 0.1 s of one core for all kinds.
ColourFit fitColour(const SeenColours& seen, const ChartColours& expected,
                    const FitOptions& options, Progress& progress);

}  // namespace patina::calibration
