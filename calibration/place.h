// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace patina::calibration {

// A place in a picture: pixel centres at whole numbers, x right, y down.
struct PlacePx {
  double x = 0, y = 0;
};

}  // namespace patina::calibration
