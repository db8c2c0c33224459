// SPDX-License-Identifier: GPL-3.0-or-later
// Fields over a sample grid. Private to the twin.
#pragma once

#include <vector>

#include "devices/twin/specimen.h"

namespace patina::devices::twin {

// d field / d x_mm and y_mm by central differences along rows and columns, which may lie anyhow;
// each clamped to +-limit.
void differentiate(const SampleGrid& grid, const std::vector<float>& field, std::vector<float>& dx,
                   std::vector<float>& dy, float limit);

// The edge of a front that passes texels at given times: never sharper in time than `time` and in
// space than `mm`, nor than a texel.
struct FrontEdge {
  float time = 0.02f;  // share of the process
  float mm = 0.1f;
  float width_max = 0.3f;  // in time
  float slope_max = 0.5f;  // share of the process a mm; steeper ones are taken for this
};
// Makes of arrival times when each texel begins to turn, and how fast it turns; and the arrivals'
// slopes. A texel that averages a steep front begins earlier by half of what it is wider.
void soften(const SampleGrid& grid, const FrontEdge& edge, std::vector<float>& arrival,
            std::vector<float>& inverse_width, std::vector<float>& dx, std::vector<float>& dy);

struct Bounds {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // mm
};
Bounds boundsOf(const SampleGrid& grid, float margin_mm);

}  // namespace patina::devices::twin
