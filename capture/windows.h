// SPDX-License-Identifier: GPL-3.0-or-later
// Windows of the day, in the plan's fixed offset from UTC: daylight saving does not move them.
#pragma once

#include <optional>

#include "capture/plan.h"

namespace patina::capture {

// Half-open: from <= time of day < to; over midnight where to < from. No windows: always.
bool insideWindows(const Plan& plan, UtcTime utc);

// When the next window opens, at or after `utc`; nothing when it is open now.
std::optional<UtcTime> nextOpening(const Plan& plan, UtcTime utc);

}  // namespace patina::capture
