// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "processing/image/failure.h"

namespace patina::calibration {

// The one exception of calibration/: the values given cannot give an estimate (kBadData, kUsage).
class CalibrationError : public Failure {
 public:
  using Failure::Failure;
};

}  // namespace patina::calibration
