// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/specimen_pose.h"

#include <gtest/gtest.h>

#include <cmath>

#include "devices/twin/point.h"

namespace patina::devices::twin {
namespace {

TEST(SpecimenPose, AtHomeChangesNothing) {
  const SampleGrid grid = SampleGrid::regular({8, 6}, 60);
  EXPECT_EQ(onSpecimen(grid, {}, 60).x_mm, grid.x_mm);
}

TEST(SpecimenPose, IsUndoneByTheWayItIsWrittenDown) {
  const SampleGrid grid = SampleGrid::regular({32, 24}, 60);
  const SpecimenPose pose{1.5, -0.7, 20, 0.08};
  const SampleGrid on = onSpecimen(grid, pose, 60);
  const double c = std::cos(radians(20)), s = std::sin(radians(20));
  for (std::size_t k = 0; k < grid.x_mm.size(); ++k) {
    const double q = on.x_mm[k] / 30, x = on.x_mm[k] * (1 - 0.08 * (1 - q * q / 3)), y = on.y_mm[k];
    EXPECT_NEAR(c * x - s * y + 1.5, grid.x_mm[k], 1e-4);
    EXPECT_NEAR(s * x + c * y - 0.7, grid.y_mm[k], 1e-4);
  }
}

TEST(SpecimenPose, ACuppedSpecimenLeansOutwardsAsItsHeightSays) {
  const SampleGrid grid = SampleGrid::regular({60, 1}, 60);
  const SpecimenPose pose{0, 0, 0, 0.2};
  const SampleGrid on = onSpecimen(grid, pose, 60);
  SurfaceRow row(60);
  for (int x = 0; x < 60; ++x) row[SurfaceRow::kNormalZ][x] = 1;
  poseRow(on, 0, pose, 60, row);
  for (int x = 1; x + 1 < 60; ++x) {
    const float rise = row[SurfaceRow::kHeight][x + 1] - row[SurfaceRow::kHeight][x - 1],
                way = on.x_mm[x + 1] - on.x_mm[x - 1];
    EXPECT_NEAR(-row[SurfaceRow::kNormalX][x] / row[SurfaceRow::kNormalZ][x], rise / way, 1e-3);
    EXPECT_NEAR(std::hypot(row[SurfaceRow::kNormalX][x], row[SurfaceRow::kNormalZ][x]), 1, 1e-5);
  }
}

}  // namespace
}  // namespace patina::devices::twin
