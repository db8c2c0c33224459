// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "devices/config_file.h"
#include "tests/devices/twin/troubled_frames.h"

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

TEST(TwinLight, RefusesALevelOutsideZeroToOne) {
  Bench bench(benchRig("grey_card", "64x48"));
  EXPECT_EQ(bench.rig.lights[0]->set(1.5).error().code, Errc::kRefused);
  EXPECT_EQ(bench.rig.lights[0]->set(std::nan("")).error().code, Errc::kRefused);
  EXPECT_TRUE(bench.rig.lights[0]->set(0.5));
}

TEST(TwinLight, SaysWhatItIsAndThatItCannotTellWhetherItIsOn) {
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.lights[1].settings["kind"] = "led";
  Bench bench(spec);
  EXPECT_TRUE(bench.rig.lights[0]->caps().incandescent);
  EXPECT_FALSE(bench.rig.lights[1]->caps().incandescent);
  EXPECT_EQ(*bench.rig.lights[0]->isOn(), std::nullopt);
}

TEST(TwinSensor, LuxFollowsTheLampsAndNeedsNoSettleTime) {
  Bench bench(benchRig("grey_card", "64x48"));
  Sensor& lux = *bench.rig.sensors[0];
  EXPECT_EQ(lux.read()->value, 0);
  bench.light(0, 1);
  bench.advance(2h);
  const double one = lux.read()->value;
  EXPECT_GT(one, 700);
  bench.light(1, 1);
  EXPECT_GT(lux.read()->value, one * 1.5);
  EXPECT_EQ(std::string(unit(lux.caps().quantity)), "lx");
}

TEST(TwinSensor, LuxNoiseIsATenthOfAPercent) {
  Bench bench(benchRig("grey_card", "64x48"));
  bench.light(0, 1);
  bench.advance(10h);
  double sum = 0, sum2 = 0;
  const int n = 5000;
  for (int i = 0; i < n; ++i) {
    bench.advance(1s);
    const double v = bench.rig.sensors[0]->read()->value;
    sum += v;
    sum2 += v * v;
  }
  const double mean = sum / n;
  EXPECT_NEAR(std::sqrt(sum2 / n - mean * mean) / mean, 0.001, 1e-4);
}

TEST(TwinSensor, TemperatureAndHumidityAreOfARoom) {
  Bench bench(benchRig("grey_card", "64x48"));
  for (int hour = 0; hour < 48; ++hour) {
    bench.advance(1h);
    EXPECT_NEAR(bench.rig.sensors[1]->read()->value, 20, 2.5);
    EXPECT_NEAR(bench.rig.sensors[2]->read()->value, 55, 7);
  }
}

TEST(TwinSensor, ADeadLampShowsInLux) {
  TwinOptions options;
  Fault dead;
  dead.at = 1h;
  dead.device = "key";
  dead.kind = FaultKind::kLampDead;
  dead.duration = 40min;
  options.faults.faults.push_back(dead);
  Bench bench(benchRig("grey_card", "64x48"), options);
  bench.light(0, 1);
  bench.advance(70min);
  EXPECT_EQ(bench.rig.sensors[0]->read()->value, 0);
  bench.advance(1h);
  EXPECT_GT(bench.rig.sensors[0]->read()->value, 700);
}

TEST(TwinSensor, AStuckOneSaysItsFirstReadingAgainAndAgain) {
  TwinOptions options;
  options.faults.faults = {faultOf("lux", FaultKind::kSensorStuck, 0, 1h, 2h)};
  Bench bench(benchRig("grey_card", "64x48"), options);
  Sensor& lux = *bench.rig.sensors[0];
  bench.light(0, 1);
  bench.advance(90min);
  const double stuck = lux.read()->value;
  EXPECT_GT(stuck, 700);
  bench.light(0, 0);
  bench.advance(1h);
  EXPECT_EQ(lux.read()->value, stuck);
  EXPECT_EQ(lux.read()->utc, bench.clock.utc()) << "only its number is old";
  bench.advance(1h);
  EXPECT_EQ(lux.read()->value, 0);
}

TEST(TwinSensor, ASaturatedOneSaysItsMaximumAndThatItIsSaturated) {
  TwinOptions options;
  options.faults.faults = {faultOf("air", FaultKind::kSensorSaturated, 0, 1h, 2h)};
  Bench bench(benchRig("grey_card", "64x48"), options);
  Sensor& air = *bench.rig.sensors[1];
  bench.advance(2h);
  EXPECT_EQ(air.read()->value, air.caps().maximum);
  EXPECT_TRUE(air.read()->saturated);
  bench.advance(2h);
  EXPECT_NEAR(air.read()->value, 20, 2.5);
  EXPECT_FALSE(air.read()->saturated);
}

TEST(TwinLight, UnderTheWrongLampThePictureIsThatOfTheNextLamp) {
  const RigSpec spec = benchRig("grey_card", "64x48");
  const Fault wrong = faultOf("key", FaultKind::kWrongLamp, 0, 10h, 20h);
  const auto key_at = [&](const std::vector<Fault>& faults, Nanoseconds at) {
    return frameAt(spec, faults, at, {1, 0}).samples.texels();
  };
  EXPECT_EQ(key_at({wrong}, 20h), frameAt(spec, {}, 20h, {0, 1}).samples.texels());
  EXPECT_NE(key_at({wrong}, 20h), key_at({}, 20h));
  EXPECT_EQ(key_at({wrong}, 40h), key_at({}, 40h));
  const Fault cyclic = faultOf("fill", FaultKind::kWrongLamp, 0, 10h, 20h);
  EXPECT_EQ(frameAt(spec, {cyclic}, 20h, {0, 1}).samples.texels(), key_at({}, 20h))
      << "the next of the last is the first";
}

TEST(TwinLight, PlugsThatAreMovedWhileALampIsLitMoveItsLight) {
  TwinOptions options;
  options.faults.faults = {faultOf("key", FaultKind::kWrongLamp, 0, 10h, 2h)};
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.lights[1].position_mm = {0, 0, 500};
  Bench bench(spec, options);
  Sensor& lux = *bench.rig.sensors[0];
  bench.light(0, 1);
  bench.advance(9h);
  const double warm = lux.read()->value;
  bench.advance(1h + 1s);
  EXPECT_NEAR(lux.read()->value / warm, 0.97, 0.005) << "the other lamp was cold";
  bench.advance(1h);
  EXPECT_NEAR(lux.read()->value / warm, 1, 0.005);
  bench.advance(1h);
  EXPECT_NEAR(lux.read()->value / warm, 0.97, 0.005) << "so is this one by now";
}

TEST(TwinSensor, ASettingItDoesNotKnowIsRefused) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.sensors[1].settings["position_mm"] = "0,0,0";
  EXPECT_THROW(makeTwinRig(spec, {}, clock), ConfigError);
}

}  // namespace
}  // namespace patina::devices::twin
