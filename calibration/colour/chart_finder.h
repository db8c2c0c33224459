// SPDX-License-Identifier: GPL-3.0-or-later
// Where in a picture a chart of 24 fields is, by OpenCV's mcc (opened when it is needed).
#pragma once

#include <optional>

#include "calibration/colour/chart.h"
#include "processing/image/progress.h"

namespace patina::calibration {

struct FindOptions {
  int side_px = 1600;  // longer pictures are made smaller to find it, in [400, 8000]
  void check() const;
};
// Nothing when there is none that mcc can tell. `linear` is [h][w][3]; it is white-balanced by its
// brightest texels and given a gamma, for mcc looks at pictures made for the eye. The corners are
// in pixels of `linear`; which way up the chart lies is for orientationOf() to say. About 0.5 s of
// one core at 1600 pixels.
std::optional<ChartCorners> findChart(ImageView<const float> linear, const FindOptions& options,
                                      Progress& progress);

}  // namespace patina::calibration
