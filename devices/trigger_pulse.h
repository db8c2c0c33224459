// SPDX-License-Identifier: GPL-3.0-or-later
// How a shutter line is pressed and let go, whatever drives it.
#pragma once

#include <functional>

#include "devices/clock.h"
#include "devices/result.h"
#include "devices/settings.h"

namespace patina::devices {

struct TriggerPulse {
  Nanoseconds pulse{};  // how long the line is active
  Nanoseconds half{};   // how long the half-press line is active before it
};
// pulse = "100ms", half = "300ms".
TriggerPulse takeTriggerPulse(Settings& settings);

using LineDrive = std::function<Result<void>(bool active)>;
// Half-press (where `half_line` is given), press, let go of both; both are let go of whatever
// fails. Answers when the line went active. Blocks for half + pulse.
Result<MonoTime> press(const TriggerPulse& pulse, const LineDrive& line, const LineDrive& half_line,
                       Clock& clock);

}  // namespace patina::devices
