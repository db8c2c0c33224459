// SPDX-License-Identifier: GPL-3.0-or-later
// The deviance gate: whether a chart may be believed. A wet, tilted or shaded chart, one with a
// glare, another chart or a picture that is not linear would be fitted as well as they allow, and
// every frame would carry the error; so they are refused, with a sentence each.
//
// What the 3x3 fit leaves of the fields' luminance is split into light that falls off across the
// chart (a plane in log light over column and row), the slope of the picture's numbers against
// light (gamma: 1 when linear) and the rest; what the greys have over a line through nothing is
// light that comes from no field (a veil: glare, a wrong black level).
#pragma once

#include <string>
#include <vector>

#include "calibration/colour/chart.h"
#include "calibration/colour/colour_fit.h"

namespace patina::calibration {

struct CheckOptions {
  double gradient_max = 0.35;    // of the light, darkest to brightest field, in (0, 10]
  double tilt_max_deg = 25;      // in (0, 90]: 90 allows every pose
  double unevenness_max = 0.06;  // within a field, in (0, 1]
  double saturated_max = 0.01;   // share of a field's texels, in [0, 1]
  double veil_max = 0.02;        // share of white, in (0, 1]
  double gamma_off_max = 0.1;    // in (0, 1]
  double lone_max = 0.2;         // one field's luminance against all others, in (0, 1]
  double delta_e_mean_max = 5;   // of the fit, in (0, 100]
  void check() const;
};

struct ChartVerdict {
  ChartSense sense = ChartSense::kUpright;
  double misfit = 0;                // of the 3x3 fit, the plane of light taken out
  double gradient = 0;              // brightest over darkest - 1, of the plane
  double light_x = 0, light_y = 0;  // log light a column and a row
  double tilt_deg = 0;
  double unevenness = 0, saturated = 0, lone = 0;  // of the worst field, and which it is:
  int uneven_field = 0, saturated_field = 0, lone_field = 0;
  double gamma = 1, veil = 0;
  std::vector<std::string> refusals;  // sentences; none: it may be believed
};
struct CheckedChart {
  ChartSamples samples;  // in the maker's order, whichever way the chart lay
  SeenColours seen;      // of the fields, the plane of light taken out (its mean stays)
  ChartVerdict verdict;
};
CheckedChart checkChart(const ChartSamples& samples, const ChartColours& expected,
                        const CheckOptions& options);

// What the fit itself says: nothing, or a sentence.
std::string fitRefusal(const ColourFitReport& report, const CheckOptions& options);

}  // namespace patina::calibration
