// SPDX-License-Identifier: GPL-3.0-or-later
// The 3x3 matrix of least relative error between what a camera saw and what a chart is: where the
// fit and every check of a chart begin.
#pragma once

#include "calibration/colour/reference_chart.h"

namespace patina::calibration {

using SeenColours = std::array<Rgb, kChartFields>;  // share of full scale, linear

struct PlainMatrix {
  Matrix3 xyz_from_camera{};
  double misfit = 0;  // RMS of what it leaves, share of a field's Y + 0.05; infinite: no fit
};
PlainMatrix plainMatrix(const SeenColours& seen, const ChartColours& expected);

}  // namespace patina::calibration
