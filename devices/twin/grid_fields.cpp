// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grid_fields.h"

#include <algorithm>
#include <cmath>

namespace patina::devices::twin {

void differentiate(const SampleGrid& grid, const std::vector<float>& field, std::vector<float>& dx,
                   std::vector<float>& dy, float limit) {
  const int w = grid.size.width, h = grid.size.height;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const std::size_t left = grid.index(std::max(x - 1, 0), y),
                        right = grid.index(std::min(x + 1, w - 1), y),
                        above = grid.index(x, std::max(y - 1, 0)),
                        below = grid.index(x, std::min(y + 1, h - 1));
      // Along a row and along a column the field changes by what its slopes make of the way.
      const float ax = grid.x_mm[right] - grid.x_mm[left], ay = grid.y_mm[right] - grid.y_mm[left],
                  bx = grid.x_mm[below] - grid.x_mm[above],
                  by = grid.y_mm[below] - grid.y_mm[above];
      const float a = field[right] - field[left], b = field[below] - field[above];
      const float area = ax * by - ay * bx;
      const std::size_t k = grid.index(x, y);
      const bool flat = std::abs(area) < 1e-18f;  // a single row or column
      dx[k] = std::clamp(flat ? (std::abs(ax) > 0 ? a / ax : 0) : (a * by - b * ay) / area, -limit,
                         limit);
      dy[k] = std::clamp(flat ? (std::abs(by) > 0 ? b / by : 0) : (b * ax - a * bx) / area, -limit,
                         limit);
    }
}

void soften(const SampleGrid& grid, const FrontEdge& edge, std::vector<float>& arrival,
            std::vector<float>& inverse_width, std::vector<float>& dx, std::vector<float>& dy) {
  differentiate(grid, arrival, dx, dy, edge.slope_max);
  for (std::size_t k = 0; k < arrival.size(); ++k) {
    const float slope = std::hypot(dx[k], dy[k]);
    const float rim = std::min(std::hypot(edge.time, edge.mm * slope), edge.width_max);
    const float width = std::min(std::hypot(rim, grid.texel_mm * slope), edge.width_max);
    arrival[k] -= (width - rim) / 2;
    inverse_width[k] = 1 / width;
  }
}

Bounds boundsOf(const SampleGrid& grid, float margin_mm) {
  const auto [x0, x1] = std::minmax_element(grid.x_mm.begin(), grid.x_mm.end());
  const auto [y0, y1] = std::minmax_element(grid.y_mm.begin(), grid.y_mm.end());
  return {*x0 - margin_mm, *y0 - margin_mm, *x1 + margin_mm, *y1 + margin_mm};
}

}  // namespace patina::devices::twin
