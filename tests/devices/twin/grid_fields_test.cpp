// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grid_fields.h"

#include <gtest/gtest.h>

#include <utility>

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

// Arrivals that rise by 0.1 a mm, on texels of `texel_mm`: when a texel in the middle begins and
// ends.
std::pair<float, float> softened(float texel_mm, const FrontEdge& edge) {
  const SampleGrid grid = SampleGrid::regular({8, 8}, 8 * texel_mm);
  std::vector<float> arrival(64), inverse_width(64), dx(64), dy(64);
  for (std::size_t k = 0; k < 64; ++k) arrival[k] = 0.5f + 0.1f * grid.x_mm[k];
  const float before = arrival[27];
  soften(grid, edge, arrival, inverse_width, dx, dy);
  EXPECT_NEAR(dx[27], 0.1f, 1e-4);
  return {arrival[27] - before, arrival[27] + 1 / inverse_width[27] - before};
}

TEST(GridFields, AFrontIsNeverSharperThanItsEdge) {
  const auto [begin, end] = softened(1e-3f, {0.03f, 0.4f, 0.5f, 1.0f});
  EXPECT_NEAR(begin, 0, 1e-5);
  EXPECT_NEAR(end, 0.05f, 1e-4) << "3, 4, 5: 0.03 in time and 0.4 mm of 0.1 a mm";
}

TEST(GridFields, AFrontIsNoSharperThanATexelAndKeepsItsMiddle) {
  const auto [begin, end] = softened(1.2f, {0.03f, 0.4f, 0.5f, 1.0f});
  EXPECT_NEAR(end - begin, 0.13f, 1e-4) << "5, 12, 13";
  EXPECT_NEAR((begin + end) / 2, 0.025f, 1e-4);
}

TEST(GridFields, AFrontIsNeverWiderThanItsLimit) {
  const auto [begin, end] = softened(4, {0.03f, 0.4f, 0.2f, 1.0f});
  EXPECT_NEAR(end - begin, 0.2f, 1e-4);
}

TEST(GridFields, BoundsHoldTheGridAndTheMargin) {
  const Bounds b = boundsOf(SampleGrid::regular({10, 10}, 10), 2);
  EXPECT_FLOAT_EQ(b.x0, -6.5f);
  EXPECT_FLOAT_EQ(b.y1, 6.5f);
}

}  // namespace
}  // namespace patina::devices::twin
