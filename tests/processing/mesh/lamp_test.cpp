// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/mesh/lamp.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/failure.h"

namespace patina::mesh {
namespace {

TEST(Lamp, SpreadOverItsDiscKeepsItsMiddleAndItsWidth) {
  const std::vector<Lamp> lamps = spreadOf({false, {0, 0, 100}}, {10, 400});
  double x = 0, y = 0, widest = 0;
  for (const Lamp& lamp : lamps) {
    EXPECT_NEAR(lamp.at[2], 100, 1e-9);
    x += lamp.at[0] / 400;
    y += lamp.at[1] / 400;
    widest = std::max(widest, std::hypot(lamp.at[0], lamp.at[1]));
  }
  EXPECT_NEAR(x, 0, 0.1);
  EXPECT_NEAR(y, 0, 0.1);
  EXPECT_NEAR(widest, 10, 0.1);
}

TEST(Lamp, OfOneRayIsItself) {
  const std::vector<Lamp> lamps = spreadOf({true, {0, 3, 4}}, {5, 1});
  ASSERT_EQ(lamps.size(), 1u);
  EXPECT_NEAR(lamps[0].at[1], 0.6, 1e-12);
}

TEST(Lamp, RefusesNoDirectionAndWidthsThatMeanNothing) {
  EXPECT_THROW(unitOf({0, 0, 0}), ProcessingError);
  EXPECT_THROW(spreadOf({}, {-1, 4}), ProcessingError);
  EXPECT_THROW(spreadOf({}, {90, 4}), ProcessingError);
  EXPECT_THROW(spreadOf({}, {1, 0}), ProcessingError);
}

}  // namespace
}  // namespace patina::mesh
