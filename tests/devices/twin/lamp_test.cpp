// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/lamp.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

LightSpec spec(Between between = Between::kOff) {
  LightSpec s;
  s.id = "key";
  s.between = between;
  return s;
}

// Without noise from shot to shot.
LampProfile quiet() {
  LampProfile p = referenceProfile().lamp;
  p.shot_to_shot = 0;
  return p;
}

Lamp lampWith(const std::vector<Fault>& faults, const LampProfile& profile = quiet(),
              bool incandescent = true) {
  FaultPlan plan;
  plan.faults = faults;
  return {spec(), incandescent, profile, plan, 1, 0s};
}

Fault fault(FaultKind kind, Nanoseconds at, Nanoseconds duration, double amount = 0) {
  Fault f;
  f.device = "key";
  f.kind = kind;
  f.at = at;
  f.duration = duration;
  f.amount = amount;
  return f;
}

TEST(Lamp, IsDarkUntilItIsSet) {
  const Lamp lamp = lampWith({});
  EXPECT_EQ(lamp.levelOver(1h, 20ms), 0);
  EXPECT_EQ(lamp.steadyLevelAt(1h), 0);
}

TEST(Lamp, WarmsUpByThreePercentWithATimeConstantOfFiveMinutes) {
  Lamp lamp = lampWith({});
  lamp.set(1, 10s);
  EXPECT_NEAR(lamp.steadyLevelAt(10s), 0.97, 1e-9);
  EXPECT_NEAR(lamp.steadyLevelAt(10s + 5min), 1 - 0.03 / M_E, 1e-9);
  EXPECT_NEAR(lamp.steadyLevelAt(10s + 2h), 1, 1e-9);
}

TEST(Lamp, CoolsWhileItIsOff) {
  Lamp lamp = lampWith({});
  lamp.set(1, 0s);
  lamp.set(0, 2h);
  lamp.set(1, 2h + 5min);
  EXPECT_NEAR(lamp.steadyLevelAt(2h + 5min), 0.97 + 0.03 / M_E, 1e-9);
}

TEST(Lamp, ALampLeftOnBetweenShotsIsWarmAfterARestartOfTheProcess) {
  Lamp lamp(spec(Between::kOn), true, quiet(), {}, 1, 3h);
  lamp.set(0, 3h);  // recover() of the start-up, then the session's switch
  lamp.set(1, 3h);
  EXPECT_NEAR(lamp.steadyLevelAt(3h), 1, 1e-9);
}

TEST(Lamp, RippleAveragesOutOverWholeHalfPeriodsAndBeatsOtherwise) {
  Lamp lamp = lampWith({});
  lamp.set(1, 0s);
  const auto spread = [&](Nanoseconds exposure) {
    double low = 2, high = 0;
    for (int i = 0; i < 200; ++i) {
      const double v = lamp.levelOver(3h + i * 1'370'001ns, exposure);
      low = std::min(low, v);
      high = std::max(high, v);
    }
    return high - low;
  };
  EXPECT_LT(spread(10ms), 1e-6);
  EXPECT_LT(spread(20ms), 1e-6);
  // Half a period: the mean of a cosine over half its period is 2/pi of its amplitude.
  EXPECT_NEAR(spread(5ms), 0.10 * 2 / M_PI, 1e-3);
  EXPECT_NEAR(spread(100us), 0.10, 1e-3) << "the whole ripple, peak to peak";
}

TEST(Lamp, AnLedDoesNotRipple) {
  Lamp lamp = lampWith({}, quiet(), false);
  lamp.set(1, 0s);
  EXPECT_DOUBLE_EQ(lamp.levelOver(3h + 1ms, 1ms), lamp.levelOver(3h + 6ms, 1ms));
}

TEST(Lamp, ShotsDifferByATenthOfAPercent) {
  Lamp lamp = lampWith({}, referenceProfile().lamp);
  lamp.set(1, 0s);
  double sum = 0, sum2 = 0;
  const int n = 20'000;
  for (int i = 0; i < n; ++i) {
    const double v = lamp.levelOver(5h + i * 5s, 20ms);
    sum += v;
    sum2 += v * v;
  }
  const double mean = sum / n;
  EXPECT_NEAR(mean, 1, 5e-5);
  EXPECT_NEAR(std::sqrt(sum2 / n - mean * mean), 0.001, 2e-5);
}

TEST(Lamp, TheSameShotHasTheSameNoiseAfterARestart) {
  Lamp before = lampWith({}, referenceProfile().lamp), after = before;
  before.set(1, 0s);
  after.set(1, 0s);
  after.levelOver(1h, 20ms);
  EXPECT_EQ(before.levelOver(2h, 20ms), after.levelOver(2h, 20ms));
}

TEST(Lamp, ADeadLampIsDarkThenComesBackCold) {
  Lamp lamp = lampWith({fault(FaultKind::kLampDead, 10h, 40min)});
  lamp.set(1, 0s);
  EXPECT_NEAR(lamp.levelOver(9h, 20ms), 1, 1e-6);
  EXPECT_EQ(lamp.levelOver(10h + 20min, 20ms), 0);
  EXPECT_NEAR(lamp.steadyLevelAt(10h + 40min), 0.97, 1e-4);
  EXPECT_NEAR(lamp.levelOver(12h, 20ms), 1, 1e-6);
}

TEST(Lamp, AStepTakesTheShareOfAnExposureItCovers) {
  Lamp lamp = lampWith({fault(FaultKind::kLampStep, 2h, 1h, -0.05)});
  lamp.set(1, 0s);
  EXPECT_NEAR(lamp.levelOver(2h + 1min, 20ms), 0.95, 1e-6);
  EXPECT_NEAR(lamp.levelOver(2h - 10ms, 20ms), 0.975, 1e-6);
  EXPECT_NEAR(lamp.levelOver(4h, 20ms), 1, 1e-6);
}

TEST(Lamp, ADriftGrowsByTheDayAndStaysWhereItEnds) {
  Lamp lamp = lampWith({fault(FaultKind::kLampDrift, 24h, 48h, -0.01)});
  lamp.set(1, 0s);
  EXPECT_NEAR(lamp.levelOver(12h, 20ms), 1, 1e-6);
  EXPECT_NEAR(lamp.levelOver(48h, 20ms), 0.99, 1e-6);
  EXPECT_NEAR(lamp.levelOver(96h, 20ms), 0.98, 1e-6);
}

TEST(Lamp, FaultsOfOtherDevicesLeaveItAlone) {
  Fault other = fault(FaultKind::kLampDead, 0s, 1000h);
  other.device = "fill";
  Lamp lamp = lampWith({other});
  lamp.set(1, 0s);
  EXPECT_GT(lamp.levelOver(1h, 20ms), 0.9);
}

}  // namespace
}  // namespace patina::devices::twin
