// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/world.h"

#include <gtest/gtest.h>

#include "devices/config_file.h"
#include "tests/devices/twin/bench_rig.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

TwinOptions aWeek() {
  TwinOptions options;
  options.duration = std::chrono::hours(7 * 24);
  options.start_utc = parseUtc("2024-05-01T00:00:00Z");
  return options;
}

TEST(World, TheSpecimenAgesOverTheRunAndStopsAtItsEnds) {
  VirtualClock clock(aWeek().start_utc);
  const World world(benchRig("grey_card", "64x48"), aWeek(), clock);
  EXPECT_EQ(world.specimenTimeAt(-1h), 0);
  EXPECT_DOUBLE_EQ(world.specimenTimeAt(84h), 0.5);
  EXPECT_EQ(world.specimenTimeAt(1000h), 1);
}

TEST(World, TakesTheSpecimensOwnDurationWhenNoneIsGiven) {
  VirtualClock clock(UtcTime{});
  const World world(benchRig("copper_patination", "64x48"), {}, clock);
  EXPECT_DOUBLE_EQ(world.specimenTimeAt(3h), 0.5);
}

TEST(World, ARunTimeCountsFromItsStartByUtcAlsoAfterARestart) {
  VirtualClock late(aWeek().start_utc + 30h);
  const World world(benchRig("grey_card", "64x48"), aWeek(), late);
  EXPECT_EQ(world.runTime(), 30h);
}

TEST(World, LuxIsTheSumOfTheLampsThatAreLit) {
  VirtualClock clock(aWeek().start_utc);
  World world(benchRig("grey_card", "64x48"), aWeek(), clock);
  EXPECT_EQ(world.illuminanceAt({0, 0, 0}, 0s).value, 0);
  world.setLamp(0, 1);
  const double one = world.illuminanceAt({0, 0, 0}, 5h).value;
  EXPECT_NEAR(one, 800, 1e-6);
  world.setLamp(1, 1);
  EXPECT_NEAR(world.illuminanceAt({0, 0, 0}, 5h).value, 1600, 1e-6);
  world.setLamp(0, 0);
  EXPECT_NEAR(world.illuminanceAt({0, 0, 0}, 5h).value, 800, 1e-6);
}

TEST(World, DaysAreWarmAndDryNightsCoolAndDamp) {
  VirtualClock clock(aWeek().start_utc);
  const World world(benchRig("grey_card", "64x48"), aWeek(), clock);
  EXPECT_NEAR(world.temperatureAt(15h).value, 22, 1e-9);
  EXPECT_NEAR(world.temperatureAt(27h).value, 18, 1e-9);
  EXPECT_NEAR(world.humidityAt(15h), 50, 1e-9);
  EXPECT_NEAR(world.temperatureAt(39h).value, 22, 1e-9) << "every day";
}

TEST(World, AnUnknownSpecimenOrLampKindNamesTheFile) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.twin->specimen = "moon_cheese";
  EXPECT_THROW(World(spec, {}, clock), ConfigError);
  spec = benchRig("grey_card", "64x48");
  spec.lights[0].settings["kind"] = "candle";
  EXPECT_THROW(World(spec, {}, clock), ConfigError);
}

TEST(World, ALampBehindTheSpecimenIsRefused) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.lights[0].position_mm = {0, 0, -10};
  EXPECT_THROW(World(spec, {}, clock), ConfigError);
}

}  // namespace
}  // namespace patina::devices::twin
