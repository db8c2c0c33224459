// SPDX-License-Identifier: GPL-3.0-or-later
// From a chart that is about there to where its fields are.
#pragma once

#include "calibration/colour/chart.h"

namespace patina::calibration {

// Moves the corners so that the grid goes through the centres of mass of the fields that stand out
// from the gaps between them. For corners off by less than a third of the gaps' distance; where
// fewer than 8 fields stand out, or they lie on no such grid (a tenth of the pitch RMS), the
// corners come back as they were. `linear` is [h][w][3]. O(texels of the chart).
ChartCorners refineCorners(ImageView<const float> linear, const ChartCorners& corners);

}  // namespace patina::calibration
