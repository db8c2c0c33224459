// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/clock_offset.h"

#include <gtest/gtest.h>

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;

constexpr MonoTime kNow = monoFromNs(5'000'000'000'000);
constexpr Nanoseconds kAhead = 3h + 200ms;  // of the camera's clock, against the boot timeline

UtcTime shownAt(MonoTime t, Nanoseconds resolution) {
  const UtcTime exact{t.time_since_epoch() + kAhead};
  return exact - exact.time_since_epoch() % resolution;
}

TEST(ClockOffset, OneReadingKnowsItToTheResolution) {
  ClockOffset offset;
  EXPECT_FALSE(offset.known());
  EXPECT_TRUE(offset.observe(shownAt(kNow, 1s), 1s, kNow, kNow + 5ms));
  EXPECT_EQ(offset.width(kNow + 5ms), 1005ms);
}

TEST(ClockOffset, ATickNarrowsItToThePauseBetweenReadings) {
  ClockOffset offset;
  for (MonoTime t = kNow; t < kNow + 1100ms; t += 20ms)
    ASSERT_TRUE(offset.observe(shownAt(t, 1s), 1s, t, t + 2ms));
  EXPECT_LE(offset.width(kNow + 1100ms), 30ms);
  const auto when = offset.when(shownAt(kNow + 2s, 10ms), 10ms, kNow + 2s);
  EXPECT_LE(when.earliest, kNow + 2s);
  EXPECT_GE(when.latest, kNow + 2s);
  EXPECT_LE(when.latest - when.earliest, 50ms);
}

TEST(ClockOffset, WidensByDriftAndNeverLosesTheTruth) {
  ClockOffset offset;
  offset.observe(shownAt(kNow, 10ms), 10ms, kNow, kNow);
  const Nanoseconds fresh = offset.width(kNow);
  EXPECT_EQ(offset.width(kNow + 1000s) - fresh, 200ms);
}

TEST(ClockOffset, AClockThatWasSetIsNoticedAndLearntAnew) {
  ClockOffset offset;
  offset.observe(shownAt(kNow, 10ms), 10ms, kNow, kNow + 1ms);
  EXPECT_FALSE(offset.observe(shownAt(kNow + 1h, 10ms), 10ms, kNow + 2s, kNow + 2s + 1ms));
  EXPECT_TRUE(offset.observe(shownAt(kNow + 1h + 1s, 10ms), 10ms, kNow + 3s, kNow + 3s + 1ms));
}

TEST(ClockOffset, TellsHowFarTheCameraIsAheadOfUtc) {
  ClockOffset offset;
  offset.observe(shownAt(kNow, 1ms), 1ms, kNow, kNow);
  const UtcTime utc{kNow.time_since_epoch() + 2h};
  const Nanoseconds ahead = offset.aheadOfUtc(utc, kNow);
  EXPECT_LE(ahead, 1h + 201ms);
  EXPECT_GE(ahead, 1h + 199ms);
}

TEST(ClockOffset, AnotherProcessKnowsWhatThisOneDid) {
  ClockOffset offset;
  offset.observe(shownAt(kNow, 10ms), 10ms, kNow, kNow + 5ms);
  ClockOffset again = ClockOffset::of(offset.text());
  ASSERT_TRUE(again.known());
  const MonoTime later = kNow + 100s;
  EXPECT_EQ(again.width(later), offset.width(later));
  EXPECT_EQ(again.when(shownAt(later, 10ms), 10ms, later).earliest,
            offset.when(shownAt(later, 10ms), 10ms, later).earliest);
  EXPECT_FALSE(again.observe(shownAt(later, 1s) + 5s, 1s, later, later)) << "its clock was set";
}

TEST(ClockOffset, ATextThatIsNoneIsNotKnown) {
  for (const char* text : {"", "x", "1 2", "2 1 0", "99999999999999999999 1 1"})
    EXPECT_FALSE(ClockOffset::of(text).known()) << text;
  EXPECT_EQ(ClockOffset().text(), "");
}

}  // namespace
}  // namespace patina::devices::gphoto2
