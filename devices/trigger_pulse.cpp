// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/trigger_pulse.h"

namespace patina::devices {

using namespace std::chrono_literals;

TriggerPulse takeTriggerPulse(Settings& settings) {
  TriggerPulse pulse;
  pulse.pulse = settings.takeDuration("pulse", 1ms, 5s, 100ms);
  pulse.half = settings.takeDuration("half", 0s, 5s, 0s);
  return pulse;
}

Result<MonoTime> press(const TriggerPulse& pulse, const LineDrive& line, const LineDrive& half_line,
                       Clock& clock) {
  Result<void> done;
  MonoTime active = clock.mono();
  if (half_line) {
    done = half_line(true);
    if (done) clock.sleepUntil(active + pulse.half, {});
  }
  if (done) {
    done = line(true);
    active = clock.mono();
    if (done) clock.sleepUntil(active + pulse.pulse, {});
  }
  const Result<void> released = line(false);
  const Result<void> half_released = half_line ? half_line(false) : Result<void>{};
  // A line that stays pressed is worse than one that was never pressed: it is reported first.
  for (const Result<void>& step : {released, half_released, done})
    if (!step) return tl::make_unexpected(step.error());
  return active;
}

}  // namespace patina::devices
