// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grid_fields.h"

#include <gtest/gtest.h>

namespace patina::devices::twin {
namespace {

TEST(GridFields, DerivativesOfAPlaneAreItsSlopes) {
  const SampleGrid grid = SampleGrid::regular({20, 10}, 40);
  std::vector<float> plane(grid.x_mm.size()), dx(plane.size()), dy(plane.size());
  for (std::size_t k = 0; k < plane.size(); ++k)
    plane[k] = 0.25f * grid.x_mm[k] - 0.5f * grid.y_mm[k];
  differentiate(grid, plane, dx, dy, 10);
  for (std::size_t k = 0; k < plane.size(); ++k) {
    EXPECT_NEAR(dx[k], 0.25f, 1e-5);
    EXPECT_NEAR(dy[k], -0.5f, 1e-5);
  }
}

TEST(GridFields, DerivativesAreClamped) {
  const SampleGrid grid = SampleGrid::regular({4, 4}, 4);
  std::vector<float> cliff(16), dx(16), dy(16);
  for (int k = 0; k < 16; ++k) cliff[k] = k % 4 < 2 ? 0.0f : 100.0f;
  differentiate(grid, cliff, dx, dy, 1.5f);
  EXPECT_EQ(dx[1], 1.5f);
  EXPECT_EQ(dy[1], 0.0f);
}

TEST(GridFields, BoundsHoldTheGridAndTheMargin) {
  const Bounds b = boundsOf(SampleGrid::regular({10, 10}, 10), 2);
  EXPECT_FLOAT_EQ(b.x0, -6.5f);
  EXPECT_FLOAT_EQ(b.y1, 6.5f);
}

}  // namespace
}  // namespace patina::devices::twin
