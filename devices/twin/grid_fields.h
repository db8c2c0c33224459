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

struct Bounds {
  float x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // mm
};
Bounds boundsOf(const SampleGrid& grid, float margin_mm);

}  // namespace patina::devices::twin
