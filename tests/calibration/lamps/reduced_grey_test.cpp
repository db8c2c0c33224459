// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/lamps/reduced_grey.h"

#include <gtest/gtest.h>

namespace patina::calibration {
namespace {

TEST(ReducedGrey, IsTheMeanOverChannelsAndBlocks) {
  Image<float> picture(5, 4, 2);
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 5; ++x) {
      picture.at(x, y, 0) = static_cast<float>(x);
      picture.at(x, y, 1) = static_cast<float>(3 * y);
    }
  const Image<float> grey = reducedGrey(picture.view(), 2);
  ASSERT_EQ(grey.size(), (SizePx{2, 2}));
  EXPECT_FLOAT_EQ(grey.at(1, 1), (2.5f + 7.5f) / 2);
}

TEST(ReducedGrey, LeavesTheLongerSideAtMostThatLong) {
  EXPECT_EQ(reductionTo(1024, {1024, 700}), 1);
  EXPECT_EQ(reductionTo(1024, {700, 1025}), 2);
  EXPECT_EQ(reductionTo(1024, {6000, 4000}), 6);
}

}  // namespace
}  // namespace patina::calibration
