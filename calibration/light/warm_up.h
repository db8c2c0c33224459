// SPDX-License-Identifier: GPL-3.0-or-later
// The warm-up of a lamp: level(t) = warm (1 - missing exp(-t / tau)).
#pragma once

#include <span>

#include "processing/image/units.h"

namespace patina::calibration {

struct WarmUp {
  bool found = false;   // the curve explains more than half of what the levels differ by
  double warm = 0;      // level in the end
  double missing = 0;   // share of it at t = 0; below 0 for a lamp that sags as it warms
  Nanoseconds tau{};    // time constant
  double residual = 0;  // RMS, relative
  // From t = 0 until the level lacks no more than `band`, a share.
  Nanoseconds waitFor(double band) const;
};
// Least squares: linear in warm and missing, the best tau by golden section over its logarithm,
// from the shortest distance of two times to three times their span. Times in seconds, rising.
// Throws CalibrationError(kUsage) on unequal lengths; fewer than 6 levels: not found. O(n).
WarmUp fitWarmUp(std::span<const double> time_s, std::span<const double> level);

struct Regression {
  double slope = 0, slope_error = 0;  // of y for one unit of x, and its standard error
  double correlation = 0;
  std::size_t samples = 0;
};
// Of a light's ratio on the temperature or humidity beside it. Fewer than 3 samples, or an x that
// does not move: no slope. O(n).
Regression regress(std::span<const double> x, std::span<const double> y);

}  // namespace patina::calibration
