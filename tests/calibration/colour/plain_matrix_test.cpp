// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/colour/plain_matrix.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/calibration/colour/drawn_chart.h"

namespace patina::calibration {
namespace {

TEST(PlainMatrix, FindsThePlantedCamera) {
  const Drawn drawn;
  const PlainMatrix found = plainMatrix(seenBy(drawn), drawn.colours);
  EXPECT_LT(found.misfit, 1e-9);
  const Xyz wanted{0.3, 0.4, 0.2};
  const auto xyz = mapped(found.xyz_from_camera, plainCamera(wanted));
  EXPECT_NEAR(xyz[0], wanted.x, 1e-9);
  EXPECT_NEAR(xyz[1], wanted.y, 1e-9);
  EXPECT_NEAR(xyz[2], wanted.z, 1e-9);
}

TEST(PlainMatrix, FitsNothingToFieldsThatAreAllAlike) {
  SeenColours seen;
  seen.fill({0.2, 0.2, 0.2});
  EXPECT_GT(plainMatrix(seen, chartColours(ChartEdition::kSince2014)).misfit, 0.5);
  seen.fill({0, 0, 0});
  EXPECT_TRUE(std::isinf(plainMatrix(seen, chartColours(ChartEdition::kSince2014)).misfit));
}

}  // namespace
}  // namespace patina::calibration
