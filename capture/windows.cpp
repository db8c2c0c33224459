// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/windows.h"

#include <algorithm>

namespace patina::capture {
namespace {

constexpr Nanoseconds kDay = std::chrono::hours(24);

Nanoseconds timeOfDay(const Plan& plan, UtcTime utc) {
  const Nanoseconds t = (utc + plan.utc_offset).time_since_epoch() % kDay;
  return t.count() < 0 ? t + kDay : t;  // before 1970
}

}  // namespace

bool insideWindows(const Plan& plan, UtcTime utc) {
  if (plan.windows.empty()) return true;
  const Nanoseconds t = timeOfDay(plan, utc);
  return std::any_of(plan.windows.begin(), plan.windows.end(), [&](const Window& w) {
    return w.from < w.to ? w.from <= t && t < w.to : t >= w.from || t < w.to;
  });
}

std::optional<UtcTime> nextOpening(const Plan& plan, UtcTime utc) {
  if (insideWindows(plan, utc)) return std::nullopt;
  const Nanoseconds t = timeOfDay(plan, utc);
  Nanoseconds wait = kDay;
  for (const Window& w : plan.windows) {
    Nanoseconds until = (w.from - t) % kDay;
    if (until.count() <= 0) until += kDay;
    wait = std::min(wait, until);
  }
  return utc + wait;
}

}  // namespace patina::capture
