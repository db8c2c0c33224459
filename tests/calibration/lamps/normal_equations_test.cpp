// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/normal_equations.h"

#include <gtest/gtest.h>

namespace patina::calibration {
namespace {

TEST(NormalEquations, GiveTheLineThroughWeightedPoints) {
  NormalEquations line(2);
  for (const double x : {0.0, 1.0, 2.0, 5.0}) line.add(std::vector<double>{1, x}, 3 - 2 * x);
  line.add(std::vector<double>{1, 4}, 100, 0);  // of no weight
  EXPECT_NEAR(line.solved()[0], 3, 1e-12);
  EXPECT_NEAR(line.solved()[1], -2, 1e-12);
}

TEST(NormalEquations, GiveTheCovarianceOfUnitNoise) {
  NormalEquations mean(1);
  for (int i = 0; i < 4; ++i) mean.add(std::vector<double>{1}, i, 2);
  EXPECT_NEAR(mean.covariance()[0], 1.0 / 8, 1e-12);
  EXPECT_NEAR(mean.diagonal(0), 8, 1e-12);
  mean.damp(0, 8);
  EXPECT_NEAR(mean.solved()[0], 0.75, 1e-12);
}

}  // namespace
}  // namespace patina::calibration
