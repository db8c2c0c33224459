// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "devices/camera.h"
#include "devices/result.h"
#include "devices/sensor.h"

namespace patina::devices {
namespace {

// Rows and reports tell kinds apart by these words alone.
template <class Enum>
std::set<std::string> namesUpTo(Enum last) {
  std::set<std::string> names;
  for (int i = 0; i <= static_cast<int>(last); ++i) names.insert(name(static_cast<Enum>(i)));
  return names;
}

TEST(DeviceNames, EveryKindHasAWordOfItsOwn) {
  EXPECT_EQ(namesUpTo(Errc::kRefused).size(), 6u);
  EXPECT_EQ(namesUpTo(Rung::kPowerCycle).size(), 5u);
  EXPECT_EQ(namesUpTo(Quantity::kHumidity).size(), 3u);
}

TEST(DeviceNames, NoKindIsUnknown) {
  EXPECT_FALSE(namesUpTo(Errc::kRefused).count("unknown"));
  EXPECT_FALSE(namesUpTo(Rung::kPowerCycle).count("unknown"));
  EXPECT_FALSE(namesUpTo(Quantity::kHumidity).count("unknown"));
}

TEST(DeviceNames, ReadingsCarryTheUnitsOfTheirQuantity) {
  EXPECT_STREQ(unit(Quantity::kIlluminance), "lx");
  EXPECT_STREQ(unit(Quantity::kTemperature), "degC");
  EXPECT_STREQ(unit(Quantity::kHumidity), "%");
}

}  // namespace
}  // namespace patina::devices
