// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/scaled_clock.h"

#include <gtest/gtest.h>

#include "processing/image/failure.h"

namespace patina::devices {
namespace {

using namespace std::chrono_literals;

TEST(ScaledClock, RunsSoManyTimesAsFastAsTheClockBelow) {
  VirtualClock real(parseUtc("2026-05-01T12:00:00Z"), monoFromNs(1'000'000'000'000));
  ScaledClock clock(real, 100);
  const UtcTime utc = clock.utc();
  const MonoTime mono = clock.mono();
  EXPECT_EQ(clock.sleepUntil(mono + 10min, {}), Wake::kDue);
  EXPECT_GE(clock.mono(), mono + 10min);
  EXPECT_LT(clock.mono() - mono, 10min + 1ms);
  EXPECT_EQ(clock.utc() - utc, clock.mono() - mono);
  EXPECT_NEAR(toSeconds(real.mono().time_since_epoch()), 1006, 1e-6);
}

TEST(ScaledClock, GoesOnWhereItWasWhenItIsMadeAgain) {
  VirtualClock real(parseUtc("2026-05-01T12:00:00Z"), monoFromNs(1'000'000'000'000));
  const MonoTime before = ScaledClock(real, 50).mono();
  const UtcTime utc = ScaledClock(real, 50).utc();
  real.advance(2s);
  EXPECT_EQ(ScaledClock(real, 50).mono() - before, 100s);
  EXPECT_EQ(ScaledClock(real, 50).utc() - utc, 100s);
}

TEST(ScaledClock, FollowsAStepOfTheWallClockOnce) {
  VirtualClock real(parseUtc("2026-05-01T12:00:00Z"), monoFromNs(1'000'000'000'000));
  ScaledClock clock(real, 100);
  const UtcTime utc = clock.utc();
  real.stepUtc(3s);
  EXPECT_EQ(clock.utc() - utc, 3s);
}

TEST(ScaledClock, IsAnotherBootThanTheRealOne) {
  VirtualClock real(parseUtc("2026-05-01T12:00:00Z"));
  EXPECT_NE(ScaledClock(real, 100).bootId(), real.bootId());
  EXPECT_NE(ScaledClock(real, 100).bootId(), ScaledClock(real, 50).bootId());
}

TEST(ScaledClock, RefusesASpeedThatTheRangeOfTimeDoesNotHold) {
  VirtualClock young(parseUtc("2026-05-01T12:00:00Z"));
  EXPECT_THROW(ScaledClock(young, 0.5), Failure);
  EXPECT_THROW(ScaledClock(young, 1001), Failure);
  VirtualClock old(parseUtc("2026-05-01T12:00:00Z"), MonoTime(24h * 365));
  EXPECT_THROW(ScaledClock(old, 1000), Failure);
  EXPECT_NO_THROW(ScaledClock(old, 100));
}

}  // namespace
}  // namespace patina::devices
