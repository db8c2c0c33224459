// SPDX-License-Identifier: GPL-3.0-or-later
// What to do now: a pure function of plan, state and time. No clock is read here.
//
// Within one boot, step k is due at anchor_mono + (k - anchor_number) * interval on CLOCK_BOOTTIME:
// nothing that wall time does moves it. Wall time only labels steps (due_utc) and opens windows.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "capture/plan.h"
#include "processing/image/units.h"

namespace patina::capture {

struct Now {
  UtcTime utc;
  MonoTime mono;
  std::string boot_id;
};

// Ties a step's number to both clocks. Kept as an event, so that a restart within the same boot
// finds the very same grid.
struct Anchor {
  std::string boot_id;
  std::int64_t number = 0;
  MonoTime mono;  // when step `number` is due
  UtcTime utc;    // the same moment on the wall, as believed now
};
std::string formatAnchor(const Anchor& anchor);  // one line
std::optional<Anchor> parseAnchor(const std::string& line);

struct ScheduleState {
  Anchor anchor;
  std::int64_t next_number = 0;  // the first slot without a decision
  // When this process was last known to be at work; steps due after it and long past were missed
  // (suspend, nobody running), steps due before it were overtaken by work (skipped).
  std::optional<MonoTime> awake_mono;
};

MonoTime dueMono(const Plan& plan, const ScheduleState& state, std::int64_t number);
UtcTime dueUtc(const Plan& plan, const ScheduleState& state, std::int64_t number);

// A new run that begins at `t0_utc` (now or later).
ScheduleState beginSchedule(UtcTime t0_utc, const Now& now);

// What a run left behind, for going on with it.
struct LastStep {
  std::int64_t number = 0;
  UtcTime due_utc;
};
struct Resumption {
  ScheduleState state;
  bool rebooted = false;  // the grid was tied anew to this boot's clock
  std::string note;       // what a person should know; empty: nothing
};
// Same boot: the grid of `anchor`. After a reboot: re-anchored by UTC; when UTC lies before the
// last step (no RTC, a clock set back) the run goes on at the next number, at once.
Resumption resumeSchedule(const Anchor& anchor, const std::optional<LastStep>& last,
                          const Now& now);

enum class Act {
  kWait,    // sleep until due_mono, ask again
  kShoot,   // step `number` now
  kSkip,    // steps [number, number + count) are late by more than half an interval
  kMiss,    // steps [number, number + count): nobody was running
  kFinish,  // no slot is left
};
struct Decision {
  Act act = Act::kFinish;
  std::int64_t number = 0;  // kWait: of the step waited for
  std::int64_t count = 1;   // kSkip, kMiss: slots outside the windows are left out by the caller
  MonoTime due_mono;
  UtcTime due_utc;
};
// Call with the state as it is; the caller moves next_number past what was decided.
Decision next(const Plan& plan, const ScheduleState& state, const Now& now);

// Wall time against the grid's belief: how far it stepped, when that is more than half a second.
// NTP's slewing stays below; due_utc then keeps the belief, so that stamps are evenly spaced.
std::optional<Nanoseconds> clockStep(const ScheduleState& state, const Now& now);
void acceptClockStep(ScheduleState& state, Nanoseconds step);

}  // namespace patina::capture
