// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/scheduler.h"

#include <algorithm>
#include <charconv>

#include "capture/windows.h"

namespace patina::capture {
namespace {

constexpr Nanoseconds kClockStepLeast = std::chrono::milliseconds(500);

// How many slots of the grid are due at or before `limit`.
std::int64_t slotsBefore(const Plan& plan, const ScheduleState& state, MonoTime limit) {
  const Nanoseconds since = limit - dueMono(plan, state, 0);
  if (since.count() < 0) return 0;
  return since.count() / plan.interval.count() + 1;
}

// From `first` on, the first slot inside a window; slotCount when there is none. Jumps from window
// to window, so that a long closed time costs nothing.
std::int64_t firstOpenSlot(const Plan& plan, const ScheduleState& state, std::int64_t first) {
  const std::int64_t slots = slotCount(plan);
  while (first < slots) {
    const UtcTime due = dueUtc(plan, state, first);
    const auto opening = nextOpening(plan, due);
    if (!opening) return first;
    const std::int64_t wait = (*opening - due).count();
    first += std::max<std::int64_t>(1, (wait + plan.interval.count() - 1) / plan.interval.count());
  }
  return slots;
}

template <class T>
bool takeField(std::string_view& line, std::string_view key, T& value) {
  if (!line.starts_with(key)) return false;
  line.remove_prefix(key.size());
  const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
  if (error != std::errc{}) return false;
  line.remove_prefix(static_cast<std::size_t>(end - line.data()));
  return true;
}

}  // namespace

std::string formatAnchor(const Anchor& a) {
  return "number=" + std::to_string(a.number) + " due_mono_ns=" + std::to_string(toNs(a.mono)) +
         " due_utc_ns=" + std::to_string(toNs(a.utc)) + " boot=" + a.boot_id;
}

std::optional<Anchor> parseAnchor(const std::string& line) {
  std::string_view rest = line;
  Anchor a;
  std::int64_t mono = 0, utc = 0;
  if (!takeField(rest, "number=", a.number) || !takeField(rest, " due_mono_ns=", mono) ||
      !takeField(rest, " due_utc_ns=", utc) || !rest.starts_with(" boot="))
    return std::nullopt;
  a.mono = monoFromNs(mono);
  a.utc = utcFromNs(utc);
  a.boot_id = std::string(rest.substr(6));
  return a;
}

MonoTime dueMono(const Plan& plan, const ScheduleState& state, std::int64_t number) {
  return state.anchor.mono + (number - state.anchor.number) * plan.interval;
}

UtcTime dueUtc(const Plan& plan, const ScheduleState& state, std::int64_t number) {
  return state.anchor.utc + (number - state.anchor.number) * plan.interval;
}

ScheduleState beginSchedule(UtcTime t0_utc, const Now& now) {
  ScheduleState state;
  state.anchor = {now.boot_id, 0, now.mono + (t0_utc - now.utc), t0_utc};
  state.awake_mono = now.mono;
  return state;
}

Resumption resumeSchedule(const Anchor& anchor, const std::optional<LastStep>& last,
                          const Now& now) {
  Resumption r;
  r.state.anchor = anchor;
  r.state.next_number = last ? last->number + 1 : 0;
  if (anchor.boot_id == now.boot_id) return r;
  r.rebooted = true;
  // The newest moment whose number and wall time are both known.
  const bool row_is_newer = last && last->number >= anchor.number;
  const std::int64_t number = row_is_newer ? last->number : anchor.number;
  const UtcTime utc = row_is_newer ? last->due_utc : anchor.utc;
  if (now.utc < utc && r.state.next_number > 0) {
    r.state.anchor = {now.boot_id, r.state.next_number, now.mono, now.utc};
    r.note = "the clock says " + formatUtc(now.utc) + ", before the last step (" + formatUtc(utc) +
             "): going on at step " + std::to_string(r.state.next_number) + " at once";
    return r;
  }
  r.state.anchor = {now.boot_id, number, now.mono - (now.utc - utc), utc};
  r.note = "rebooted: steps are tied to UTC again, " +
           formatDuration(std::chrono::duration_cast<std::chrono::seconds>(now.utc - utc)) +
           " after step " + std::to_string(number) + " was due";
  return r;
}

Decision next(const Plan& plan, const ScheduleState& state, const Now& now) {
  Decision d;
  const std::int64_t slots = slotCount(plan);
  d.number = firstOpenSlot(plan, state, state.next_number);
  if (d.number >= slots) return d;
  d.due_mono = dueMono(plan, state, d.number);
  d.due_utc = dueUtc(plan, state, d.number);
  if (now.mono < d.due_mono) {
    d.act = Act::kWait;
    return d;
  }
  const auto late =
      std::min(slots, slotsBefore(plan, state, now.mono - plan.interval / 2 - Nanoseconds{1}));
  if (d.number >= late) {
    d.act = Act::kShoot;
    return d;
  }
  const auto at_work =
      state.awake_mono ? std::min(late, slotsBefore(plan, state, *state.awake_mono)) : 0;
  d.act = d.number < at_work ? Act::kSkip : Act::kMiss;
  d.count = (d.act == Act::kSkip ? at_work : late) - d.number;
  return d;
}

std::optional<Nanoseconds> clockStep(const ScheduleState& state, const Now& now) {
  const UtcTime believed = state.anchor.utc + (now.mono - state.anchor.mono);
  const Nanoseconds step = now.utc - believed;
  if (step < kClockStepLeast && step > -kClockStepLeast) return std::nullopt;
  return step;
}

void acceptClockStep(ScheduleState& state, Nanoseconds step) { state.anchor.utc += step; }

}  // namespace patina::capture
