// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scheduler.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/windows.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

const UtcTime kStart = parseUtc("2024-05-01T12:00:00Z");
const MonoTime kBoot = monoFromNs(1'000'000'000'000);

// A machine on which only the schedule runs: sleeping takes what it takes, a shot `work`.
struct Machine {
  Plan plan;
  Now now{kStart, kBoot, "boot-1"};
  ScheduleState state;
  Nanoseconds work = 100ms;
  std::vector<std::int64_t> shot, skipped, missed;
  std::vector<Nanoseconds> lateness;

  explicit Machine(Nanoseconds interval, Nanoseconds duration) {
    plan.interval = interval;
    plan.duration = duration;
    state = beginSchedule(kStart, now);
  }
  void pass(Nanoseconds d) {
    now.mono += d;
    now.utc += d;
  }
  void one(const Decision& d) {
    if (const auto step = clockStep(state, now)) acceptClockStep(state, *step);
    if (d.act == Act::kWait) {
      state.awake_mono = now.mono;
      pass(d.due_mono - now.mono);
      return;
    }
    auto& list = d.act == Act::kShoot ? shot : d.act == Act::kSkip ? skipped : missed;
    for (std::int64_t k = d.number; k < d.number + d.count; ++k)
      if (insideWindows(plan, dueUtc(plan, state, k))) list.push_back(k);
    if (d.act == Act::kShoot) {
      lateness.push_back(now.mono - d.due_mono);
      pass(work);
    }
    state.next_number = d.number + d.count;
    state.awake_mono = now.mono;
  }
  void runUntil(std::int64_t number) {
    while (state.next_number < number) {
      const Decision d = next(plan, state, now);
      if (d.act == Act::kFinish) return;
      one(d);
    }
  }
  // Asleep with the lid closed: both clocks jump.
  void sleepThrough(Nanoseconds d) {
    state.awake_mono = now.mono;
    pass(d);
  }
};

TEST(Scheduler, DoesNotDriftInAYearOfSteps) {
  Machine m(10min, 24h * 365);
  m.runUntil(slotCount(m.plan));
  ASSERT_EQ(m.shot.size(), 52560u);
  for (const Nanoseconds late : m.lateness) ASSERT_EQ(late, 0ns);
  EXPECT_EQ(m.now.mono, kBoot + 52559 * Nanoseconds(10min) + m.work);
}

TEST(Scheduler, SkipsAStepThatIsLateByMoreThanHalfAnInterval) {
  Machine m(10s, 100s);
  m.runUntil(3);
  m.now.mono += 18s;  // step 2 took long: at work all the time
  m.now.utc += 18s;
  m.state.awake_mono = m.now.mono;
  m.runUntil(10);
  EXPECT_EQ(m.skipped, (std::vector<std::int64_t>{3}));
  EXPECT_EQ(m.shot, (std::vector<std::int64_t>{0, 1, 2, 4, 5, 6, 7, 8, 9}));
}

TEST(Scheduler, ShootsAStepThatIsLateByHalfAnIntervalOrLess) {
  Machine m(10s, 100s);
  m.runUntil(3);
  m.pass(dueMono(m.plan, m.state, 3) + 5s - m.now.mono);
  const Decision d = next(m.plan, m.state, m.now);
  EXPECT_EQ(d.act, Act::kShoot);
  EXPECT_EQ(d.number, 3);
  m.pass(1ns);
  m.state.awake_mono = m.now.mono;
  EXPECT_EQ(next(m.plan, m.state, m.now).act, Act::kSkip);
}

TEST(Scheduler, KeepsItsRhythmWhenNtpStepsForward) {
  Machine m(10min, 24h);
  m.runUntil(5);
  m.now.utc += 1h;
  m.runUntil(144);
  EXPECT_EQ(m.shot.size(), 144u);
  for (const Nanoseconds late : m.lateness) ASSERT_EQ(late, 0ns);
  EXPECT_EQ(dueUtc(m.plan, m.state, 10), kStart + 100min + 1h);
}

TEST(Scheduler, KeepsItsRhythmWhenNtpStepsBack) {
  Machine m(10min, 24h);
  m.runUntil(5);
  m.now.utc -= 10h;
  m.runUntil(144);
  EXPECT_EQ(m.shot.size(), 144u);
  for (const Nanoseconds late : m.lateness) ASSERT_EQ(late, 0ns);
}

TEST(Scheduler, TellsNtpSlewingFromAStep) {
  Machine m(10min, 24h);
  m.runUntil(5);
  m.now.utc += 400ms;
  EXPECT_FALSE(clockStep(m.state, m.now).has_value());
  m.now.utc += 200ms;
  EXPECT_EQ(clockStep(m.state, m.now), 600ms);
  acceptClockStep(m.state, 600ms);
  EXPECT_FALSE(clockStep(m.state, m.now).has_value());
}

TEST(Scheduler, OpensWindowsByAFixedOffsetWhateverDaylightSavingDoes) {
  Machine m(1h, 24h * 4);
  // Berlin leaves daylight saving on 2024-10-27; the plan's offset stays +02:00.
  m.now.utc = parseUtc("2024-10-25T22:00:00Z");
  m.state = beginSchedule(m.now.utc, m.now);
  m.plan.utc_offset = 2h;
  m.plan.windows = {{8h, 10h}};
  m.runUntil(slotCount(m.plan));
  EXPECT_EQ(m.shot, (std::vector<std::int64_t>{8, 9, 32, 33, 56, 57, 80, 81}));
}

TEST(Scheduler, OpensWindowsOverMidnight) {
  Machine m(1h, 48h);
  m.plan.windows = {{22h, 2h}};
  m.runUntil(slotCount(m.plan));
  EXPECT_EQ(m.shot, (std::vector<std::int64_t>{10, 11, 12, 13, 34, 35, 36, 37}));
}

TEST(Scheduler, CallsStepsMissedThatWereDueDuringASuspendAndDoesNotCatchUp) {
  Machine m(10min, 24h);
  m.runUntil(6);
  m.sleepThrough(100min);  // 51 min on the grid to 151: steps 6..15 pass
  m.runUntil(30);
  EXPECT_EQ(m.missed, (std::vector<std::int64_t>{6, 7, 8, 9, 10, 11, 12, 13, 14}));
  EXPECT_TRUE(m.skipped.empty());
  EXPECT_EQ(m.shot.size(), 30u - 9u);
  EXPECT_EQ(m.shot[6], 15);  // woken within half an interval of it: shot once
}

TEST(Scheduler, GoesOnWithTheSameGridAfterARestartWithinOneBoot) {
  Machine m(10min, 24h);
  m.runUntil(6);
  m.pass(95min);  // the process was dead
  const auto r = resumeSchedule(m.state.anchor, LastStep{5, dueUtc(m.plan, m.state, 5)}, m.now);
  EXPECT_FALSE(r.rebooted);
  m.state = r.state;
  m.runUntil(20);
  EXPECT_EQ(m.missed, (std::vector<std::int64_t>{6, 7, 8, 9, 10, 11, 12, 13, 14}));
  EXPECT_EQ(dueMono(m.plan, m.state, 19), kBoot + 190min);
}

TEST(Scheduler, IsTiedToUtcAgainAfterAReboot) {
  Machine m(10min, 24h);
  m.runUntil(6);
  const LastStep last{5, dueUtc(m.plan, m.state, 5)};
  m.now.utc += 33min;
  m.now.mono = monoFromNs(20'000'000'000);
  m.now.boot_id = "boot-2";
  const auto r = resumeSchedule(m.state.anchor, last, m.now);
  EXPECT_TRUE(r.rebooted);
  EXPECT_THAT(r.note, ::testing::HasSubstr("rebooted"));
  m.state = r.state;
  m.runUntil(20);
  EXPECT_EQ(m.missed, (std::vector<std::int64_t>{6, 7}));
  EXPECT_EQ(m.shot[6], 8);
  EXPECT_EQ(dueUtc(m.plan, m.state, 19), kStart + 190min);
}

class MissingRtc : public ::testing::TestWithParam<const char*> {};

TEST_P(MissingRtc, GoesOnAtTheNextNumberAndKeepsItsRhythmWhenNtpPutsTheClockRight) {
  Machine m(10min, 24h);
  m.runUntil(6);
  const LastStep last{5, dueUtc(m.plan, m.state, 5)};
  m.now = {parseUtc(GetParam()), monoFromNs(20'000'000'000), "boot-2"};
  const auto r = resumeSchedule(m.state.anchor, last, m.now);
  EXPECT_THAT(r.note, ::testing::HasSubstr("before the last step"));
  m.state = r.state;
  m.runUntil(8);
  EXPECT_EQ(m.shot, (std::vector<std::int64_t>{0, 1, 2, 3, 4, 5, 6, 7}));
  m.now.utc = parseUtc("2024-05-01T14:07:00Z");  // NTP
  m.runUntil(20);
  EXPECT_EQ(m.shot.size(), 20u);
  EXPECT_TRUE(m.missed.empty() && m.skipped.empty());
  for (const Nanoseconds late : m.lateness) ASSERT_EQ(late, 0ns);
  EXPECT_GT(dueUtc(m.plan, m.state, 20), parseUtc("2024-05-01T14:07:00Z"));
}

INSTANTIATE_TEST_SUITE_P(Clocks, MissingRtc, ::testing::Values("1970-01-01", "2000-01-01"));

TEST(Scheduler, FindsThatARunWithoutRtcAtItsStartIsNotOverWhenTheClockComesRight) {
  Machine m(10min, 24h);
  m.now.utc = UtcTime{};
  m.state = beginSchedule(m.now.utc, m.now);
  m.runUntil(6);
  m.now.utc = kStart;
  m.runUntil(7);
  const LastStep last{6, dueUtc(m.plan, m.state, 6)};
  EXPECT_GT(last.due_utc, kStart);
  m.now = {kStart + 30min, monoFromNs(0), "boot-2"};
  m.state = resumeSchedule(m.state.anchor, last, m.now).state;
  m.runUntil(144);
  EXPECT_EQ(m.shot.size() + m.missed.size(), 144u);
  EXPECT_LE(m.missed.size(), 3u);
}

TEST(Scheduler, WaitsForAStartThatLiesAhead) {
  Machine m(10min, 24h);
  m.state = beginSchedule(kStart + 3h, m.now);
  const Decision d = next(m.plan, m.state, m.now);
  EXPECT_EQ(d.act, Act::kWait);
  EXPECT_EQ(d.due_mono, kBoot + 3h);
}

TEST(Scheduler, PassesAnAnchorThroughItsLine) {
  const Anchor a{"f00d-boot", 42, kBoot + 7ns, kStart - 3ns};
  const auto back = parseAnchor(formatAnchor(a));
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->boot_id, a.boot_id);
  EXPECT_EQ(back->number, 42);
  EXPECT_EQ(back->mono, a.mono);
  EXPECT_EQ(back->utc, a.utc);
  EXPECT_FALSE(parseAnchor("number=x").has_value());
}

}  // namespace
}  // namespace patina::capture
