// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/health.h"

#include <gtest/gtest.h>

namespace patina::devices::gphoto2 {
namespace {

TEST(Health, BatteriesAreReadAsMakersWriteThem) {
  EXPECT_EQ(batteryPercent("85%"), 85);
  EXPECT_EQ(batteryPercent("Low"), 10);
  EXPECT_EQ(batteryPercent("Full"), 100);
  EXPECT_EQ(batteryPercent("Unknown value 00ff"), std::nullopt);
}

}  // namespace
}  // namespace patina::devices::gphoto2
