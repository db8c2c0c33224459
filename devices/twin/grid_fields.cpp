// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grid_fields.h"

#include <algorithm>
#include <cmath>

namespace patina::devices::twin {

void differentiate(const SampleGrid& grid, const std::vector<float>& field, std::vector<float>& dx,
                   std::vector<float>& dy, float limit) {
  const int w = grid.size.width, h = grid.size.height;
  const auto slope = [&](std::size_t a, std::size_t b, const std::vector<float>& along) {
    const float distance = along[b] - along[a];
    if (std::abs(distance) < 1e-9f) return 0.0f;
    return std::min(std::max((field[b] - field[a]) / distance, -limit), limit);
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t k = grid.index(x, y);
      dx[k] = slope(grid.index(std::max(x - 1, 0), y), grid.index(std::min(x + 1, w - 1), y),
                    grid.x_mm);
      dy[k] = slope(grid.index(x, std::max(y - 1, 0)), grid.index(x, std::min(y + 1, h - 1)),
                    grid.y_mm);
    }
}

Bounds boundsOf(const SampleGrid& grid, float margin_mm) {
  const auto [x0, x1] = std::minmax_element(grid.x_mm.begin(), grid.x_mm.end());
  const auto [y0, y1] = std::minmax_element(grid.y_mm.begin(), grid.y_mm.end());
  return {*x0 - margin_mm, *y0 - margin_mm, *x1 + margin_mm, *y1 + margin_mm};
}

}  // namespace patina::devices::twin
