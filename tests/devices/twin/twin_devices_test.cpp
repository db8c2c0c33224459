// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "devices/config_file.h"
#include "tests/devices/twin/bench_rig.h"

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

TEST(TwinSensor, ASettingItDoesNotKnowIsRefused) {
  VirtualClock clock(UtcTime{});
  RigSpec spec = benchRig("grey_card", "64x48");
  spec.sensors[1].settings["position_mm"] = "0,0,0";
  EXPECT_THROW(makeTwinRig(spec, {}, clock), ConfigError);
}

}  // namespace
}  // namespace patina::devices::twin
