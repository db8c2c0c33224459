// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/clock.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "devices/suspended.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;

constexpr UtcTime kNoon = utcFromNs(1'714'564'800'000'000'000);
constexpr MonoTime kBoot = monoFromNs(1'000'000'000'000);

// What a week's runner does: shoot at t0 + k * interval of the monotonic clock.
std::vector<UtcTime> shootEvery(VirtualClock& clock, Nanoseconds interval, int count) {
  std::vector<UtcTime> taken;
  const MonoTime t0 = clock.mono();
  for (int k = 1; k <= count; ++k) {
    if (clock.sleepUntil(t0 + k * interval, {}) == Wake::kStopped) break;
    taken.push_back(clock.utc());
  }
  return taken;
}

TEST(VirtualClock, SleepingIsAdvancing) {
  VirtualClock clock(kNoon);
  EXPECT_EQ(clock.sleepUntil(kBoot + 90min, {}), Wake::kDue);
  EXPECT_EQ(clock.mono(), kBoot + 90min);
  EXPECT_EQ(clock.utc(), kNoon + 90min);
}

TEST(VirtualClock, ADeadlineThatHasPassedReturnsAtOnce) {
  VirtualClock clock(kNoon);
  EXPECT_EQ(clock.sleepUntil(kBoot - 1h, {}), Wake::kDue);
  EXPECT_EQ(clock.mono(), kBoot);
  EXPECT_EQ(clock.utc(), kNoon);
}

TEST(VirtualClock, FiresInOrderOfTimeAndEqualDeadlinesInInsertionOrder) {
  VirtualClock clock(kNoon);
  std::string order;
  clock.at(kBoot + 2s, [&] { order += 'c'; });
  clock.at(kBoot + 1s, [&] { order += 'a'; });
  clock.at(kBoot + 2s, [&] { order += 'd'; });
  clock.at(kBoot + 1s, [&] { order += 'b'; });
  clock.at(kBoot + 4s, [&] { order += 'z'; });
  clock.sleepUntil(kBoot + 3s, {});
  EXPECT_EQ(order, "abcd");
}

TEST(VirtualClock, ACallbackSeesItsOwnTimeAndMayPlanAnotherOnTheWay) {
  VirtualClock clock(kNoon);
  std::vector<Nanoseconds> seen;
  clock.at(kBoot + 1s, [&] {
    seen.push_back(clock.mono() - kBoot);
    clock.at(kBoot + 2s, [&] { seen.push_back(clock.mono() - kBoot); });
  });
  clock.advance(10s);
  EXPECT_EQ(seen, (std::vector<Nanoseconds>{1s, 2s}));
  EXPECT_EQ(clock.mono(), kBoot + 10s);
}

TEST(VirtualClock, StopEndsASleepWhereItWasAskedFor) {
  VirtualClock clock(kNoon);
  std::stop_source stop;
  bool later = false;
  clock.at(kBoot + 1min, [&] { stop.request_stop(); });
  clock.at(kBoot + 2min, [&] { later = true; });
  EXPECT_EQ(clock.sleepUntil(kBoot + 1h, stop.get_token()), Wake::kStopped);
  EXPECT_EQ(clock.mono(), kBoot + 1min);
  EXPECT_FALSE(later);
}

TEST(VirtualClock, AnNtpStepMovesUtcAndNoDeadline) {
  VirtualClock clock(kNoon);
  clock.at(kBoot + 25min, [&] { clock.stepUtc(-3s); });
  const auto taken = shootEvery(clock, 10min, 4);
  ASSERT_EQ(taken.size(), 4u);
  EXPECT_EQ(clock.mono(), kBoot + 40min);
  EXPECT_EQ(taken[1] - taken[0], 10min);
  EXPECT_EQ(taken[2] - taken[1], 10min - 3s);
  EXPECT_EQ(taken[3] - taken[2], 10min);
}

TEST(VirtualClock, AMissingRtcThatIsSetLaterMovesUtcByYears) {
  VirtualClock clock(utcFromNs(0));
  clock.at(kBoot + 15min, [&] { clock.stepUtc(kNoon - clock.utc()); });
  const auto taken = shootEvery(clock, 10min, 3);
  EXPECT_EQ(taken[0], utcFromNs(0) + 10min);
  EXPECT_EQ(taken[1], kNoon + 5min);
  EXPECT_EQ(clock.mono(), kBoot + 30min);
}

TEST(VirtualClock, ASleepThatASuspendOverrunsIsDueLate) {
  VirtualClock clock(kNoon);
  std::vector<Nanoseconds> fired;
  clock.at(kBoot + 5min, [&] { clock.suspend(2h); });
  clock.at(kBoot + 30min, [&] { fired.push_back(clock.mono() - kBoot); });
  EXPECT_EQ(clock.sleepUntil(kBoot + 10min, {}), Wake::kDue);
  EXPECT_EQ(clock.mono(), kBoot + 2h + 5min);
  EXPECT_EQ(clock.utc(), kNoon + 2h + 5min);
  EXPECT_EQ(fired, (std::vector<Nanoseconds>{2h + 5min}));
}

TEST(VirtualClock, CallbacksPlannedInsideASuspendFireOnResume) {
  VirtualClock clock(kNoon);
  int fired = 0;
  clock.at(kBoot + 1min, [&] { ++fired; });
  clock.suspend(1h);
  EXPECT_EQ(fired, 1);
}

TEST(VirtualClock, ARebootEndsTheSleepAndChangesTheBootId) {
  VirtualClock clock(kNoon, kBoot, "first");
  clock.at(kBoot + 1h, [&] { clock.reboot(2min, "second", monoFromNs(30'000'000'000)); });
  EXPECT_EQ(clock.sleepUntil(kBoot + 5h, {}), Wake::kStopped);
  EXPECT_EQ(clock.bootId(), "second");
  EXPECT_EQ(clock.mono(), monoFromNs(30'000'000'000));
  EXPECT_EQ(clock.utc(), kNoon + 1h + 2min);
}

TEST(VirtualClock, WhatTheWorldHasPlannedKeepsItsHourOverAReboot) {
  VirtualClock clock(kNoon);
  std::vector<UtcTime> fired;
  clock.at(kBoot + 10min, [&] { fired.push_back(clock.utc()); });
  clock.at(kBoot + 90s, [&] { fired.push_back(clock.utc()); });
  clock.advance(1min);
  clock.reboot(2min, "second", monoFromNs(0));
  clock.advance(1h);
  EXPECT_EQ(fired, (std::vector<UtcTime>{kNoon + 3min, kNoon + 10min}));
}

TEST(VirtualClock, ACallbackThatThrowsLeavesTheClockUsable) {
  VirtualClock clock(kNoon);
  int fired = 0;
  clock.at(kBoot + 1s, [] { throw std::runtime_error("lamp"); });
  clock.at(kBoot + 2s, [&] { ++fired; });
  EXPECT_THROW(clock.advance(5s), std::runtime_error);
  clock.suspend(5s);
  EXPECT_EQ(fired, 1);
}

TEST(VirtualClock, OneHundredThousandSleepsEndExactlyOnTime) {
  VirtualClock clock(kNoon);
  shootEvery(clock, 6048ms, 100'000);
  EXPECT_EQ(clock.mono(), kBoot + 7 * 24h);
}

TEST(RealClock, NeverWakesBeforeItsDeadline) {
  RealClock clock;
  for (int i = 0; i < 20; ++i) {
    const MonoTime due = clock.mono() + 300us;
    EXPECT_EQ(clock.sleepUntil(due, {}), Wake::kDue);
    EXPECT_GE(clock.mono(), due);
  }
}

TEST(RealClock, AnHourOfSleepEndsWhenStopIsAskedForFromAnotherThread) {
  RealClock clock;
  std::stop_source stop;
  const MonoTime due = clock.mono() + 1h;
  std::jthread stopper([&] { stop.request_stop(); });
  EXPECT_EQ(clock.sleepUntil(due, stop.get_token()), Wake::kStopped);
  EXPECT_LT(clock.mono(), due);
}

TEST(RealClock, AStopOfOneSleepDoesNotCutTheNextOneShort) {
  RealClock clock;
  for (int i = 0; i < 50; ++i) {
    std::stop_source stop;
    {
      std::jthread stopper([&] { stop.request_stop(); });
      clock.sleepUntil(clock.mono() + 100us, stop.get_token());
    }
    const MonoTime due = clock.mono() + 100us;
    EXPECT_EQ(clock.sleepUntil(due, {}), Wake::kDue);
    EXPECT_GE(clock.mono(), due);
  }
}

TEST(RealClock, BelongsToOneBootAndKnowsIt) {
  const RealClock clock;
  EXPECT_EQ(clock.bootId().size(), 36u);
  EXPECT_EQ(clock.bootId(), RealClock().bootId());
  EXPECT_GT(toNs(clock.mono()), 0);
  EXPECT_GT(clock.utc(), utcFromNs(0));
}

// A machine that does not sleep during the test has slept as long after it as before.
TEST(SleptSinceBoot, IsNoTimeThatTheMachineWasAwake) {
  const Nanoseconds before = sleptSinceBoot();
  EXPECT_GT(before, -1ms);
  for (int i = 0; i < 1000; ++i) EXPECT_LT(std::chrono::abs(sleptSinceBoot() - before), 1s);
}

}  // namespace
}  // namespace patina::devices
