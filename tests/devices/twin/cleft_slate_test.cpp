// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/cleft_slate.h"

#include <gtest/gtest.h>

namespace patina::devices::twin {
namespace {

const CleftSlate& slate() {
  static const CleftSlate slate(11);
  return slate;
}

TEST(CleftSlate, ALayerIsFlatAndEndsInALedge) {
  EXPECT_EQ(cleft(2.1f, 0.2f), 2);
  EXPECT_EQ(cleft(2.39f, 0.2f), 2);
  EXPECT_NEAR(cleft(2.5f, 0.2f), 2.5, 1e-5);
  EXPECT_EQ(cleft(2.61f, 0.2f), 3);
  EXPECT_EQ(cleft(-0.9f, 0.2f), -1) << "below zero too";
}

TEST(CleftSlate, HasSeveralLayersAndABroadFormBeneath) {
  float lowest = 9, highest = -9, off = 0;
  for (float y = -60; y <= 60; y += 2)
    for (float x = -60; x <= 60; x += 2) {
      lowest = std::min(lowest, slate().layersAt(x, y));
      highest = std::max(highest, slate().layersAt(x, y));
      off += std::abs(slate().layersAt(x, y) - slate().formAt(x, y)) / (61 * 61);
    }
  EXPECT_GT(highest - lowest, 3);
  EXPECT_LT(off, 0.5f);
}

TEST(CleftSlate, TheFootOfALedgeIsShelteredOnTheLeeSideOnly) {
  double lee = 0, lees = 0, luff = 0, luffs = 0;
  for (float y = -60; y <= 60; y += 0.7f)
    for (float x = -60; x <= 60; x += 0.7f) {
      const auto layer = [&](float along) {
        return cleft(
            slate().layersAt(x + along * CleftSlate::kWindX, y + along * CleftSlate::kWindY),
            0.05f);
      };
      const float here = layer(0), before = layer(-2.5f) - here, after = layer(2.5f) - here;
      if (before > 0.9f && after < 0.1f) {
        ++lees;
        lee += slate().exposureAt(x, y);
      } else if (after > 0.9f && before < 0.1f) {
        ++luffs;
        luff += slate().exposureAt(x, y);
      }
    }
  ASSERT_GT(lees, 100);
  ASSERT_GT(luffs, 100);
  EXPECT_LT(lee / lees, luff / luffs - 0.4);
}

TEST(CleftSlate, DriftsHaveNoEdges) {
  float steepest = 0, least = 1, most = -1;
  for (float y = -60; y <= 60; y += 1.3f)
    for (float x = -60; x <= 60; x += 1.3f) {
      const float here = slate().driftAt(x, y);
      steepest = std::max(steepest, std::abs(slate().driftAt(x + 0.1f, y) - here) / 0.1f);
      least = std::min(least, here);
      most = std::max(most, here);
    }
  EXPECT_LT(steepest, 0.25f) << "a mm";
  EXPECT_GT(most - least, 0.6f);
}

}  // namespace
}  // namespace patina::devices::twin
