// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/sensor_settings.h"

#include <gmock/gmock.h>

#include <limits>

#include "devices/config_file.h"
#include "tests/support/matchers.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

SensorSpec sensor(Quantity quantity, std::map<std::string, std::string> settings = {}) {
  SensorSpec spec;
  spec.id = "air0";
  spec.quantity = quantity;
  spec.settings = std::move(settings);
  return spec;
}
SensorCaps capsOf(const SensorSpec& spec) {
  Settings settings(spec.settings, "sensor 'air0'", "rig.toml");
  SensorCaps caps = takeSensorCaps(settings, spec);
  settings.finish();
  return caps;
}

TEST(SensorSettings, EachQuantityHasARangeOfItsOwn) {
  EXPECT_EQ(capsOf(sensor(Quantity::kTemperature)).minimum, -40);
  EXPECT_EQ(capsOf(sensor(Quantity::kHumidity)).maximum, 100);
  EXPECT_EQ(capsOf(sensor(Quantity::kIlluminance)).maximum, 120'000);
  const SensorCaps caps =
      capsOf(sensor(Quantity::kIlluminance, {{"maximum", "4000"}, {"integration", "400ms"}}));
  EXPECT_EQ(caps.maximum, 4000);
  EXPECT_EQ(caps.integration, 400ms);
}

TEST(SensorSettings, RefuseARangeThatIsNoneAndAScaleOfNothing) {
  EXPECT_THROW(capsOf(sensor(Quantity::kHumidity, {{"maximum", "-3"}})), ConfigError);
  const std::map<std::string, std::string> values{{"scale", "0"}};
  Settings settings(values, "sensor 'air0'", "rig.toml");
  EXPECT_THROW(takeSensorScale(settings), ConfigError);
}

TEST(SensorSettings, AValueAtTheEndOfItsRangeIsHeldThereAndSaturated) {
  const VirtualClock clock(kStart);
  const SensorCaps lux = capsOf(sensor(Quantity::kIlluminance));
  EXPECT_TRUE(readingOf(1e9, lux, clock)->saturated);
  EXPECT_EQ(readingOf(1e9, lux, clock)->value, lux.maximum);
  EXPECT_FALSE(readingOf(0, lux, clock)->saturated);
  EXPECT_TRUE(readingOf(-1, lux, clock)->saturated);
  EXPECT_EQ(readingOf(-1, lux, clock)->value, 0);
  const SensorCaps air = capsOf(sensor(Quantity::kTemperature));
  EXPECT_TRUE(readingOf(-40, air, clock)->saturated);
  EXPECT_FALSE(readingOf(21.5, air, clock)->saturated);
  EXPECT_EQ(readingOf(21.5, air, clock)->utc, kStart);
}

TEST(SensorSettings, WhatIsNoNumberIsNoReading) {
  const VirtualClock clock(kStart);
  const SensorCaps lux = capsOf(sensor(Quantity::kIlluminance));
  EXPECT_THAT(readingOf(std::numeric_limits<double>::quiet_NaN(), lux, clock),
              Fails(Errc::kCorrupt));
  EXPECT_THAT(readingOf(std::numeric_limits<double>::infinity(), lux, clock),
              Fails(Errc::kCorrupt));
}

}  // namespace
}  // namespace patina::devices
