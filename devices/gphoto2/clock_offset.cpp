// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/clock_offset.h"

#include <algorithm>
#include <sstream>

namespace patina::devices::gphoto2 {

namespace {

// A bad quartz in the cold, and the crystal of this machine.
constexpr double kDriftShare = 1e-4;

Nanoseconds since(MonoTime earlier, UtcTime shown) {
  return shown.time_since_epoch() - earlier.time_since_epoch();
}

}  // namespace

ClockOffset::Interval ClockOffset::widened(MonoTime at) const {
  const Nanoseconds elapsed = at > seen_ ? at - seen_ : Nanoseconds{};
  const Nanoseconds drift = fromSeconds(toSeconds(elapsed) * kDriftShare);
  return {known_->least - drift, known_->most + drift};
}

bool ClockOffset::observe(UtcTime shown, Nanoseconds resolution, MonoTime from, MonoTime to) {
  const Interval seen{since(to, shown), since(from, shown) + resolution};
  if (!known_) {
    known_ = seen;
    seen_ = to;
    return true;
  }
  const Interval before = widened(to);
  const Interval both{std::max(before.least, seen.least), std::min(before.most, seen.most)};
  seen_ = to;
  if (both.least <= both.most) {
    known_ = both;
    return true;
  }
  known_ = seen;
  return false;
}

Nanoseconds ClockOffset::width(MonoTime at) const {
  const Interval now = widened(at);
  return now.most - now.least;
}

ClockOffset::Span ClockOffset::when(UtcTime shown, Nanoseconds resolution, MonoTime at) const {
  const Interval now = widened(at);
  return {MonoTime{shown.time_since_epoch() - now.most},
          MonoTime{shown.time_since_epoch() + resolution - now.least}};
}

Nanoseconds ClockOffset::aheadOfUtc(UtcTime utc, MonoTime at) const {
  const Interval now = widened(at);
  const Nanoseconds middle = now.least + (now.most - now.least) / 2;
  return middle - (utc.time_since_epoch() - at.time_since_epoch());
}

std::string ClockOffset::text() const {
  if (!known_) return "";
  return std::to_string(known_->least.count()) + " " + std::to_string(known_->most.count()) + " " +
         std::to_string(seen_.time_since_epoch().count());
}

ClockOffset ClockOffset::of(const std::string& text) {
  std::istringstream in(text);
  std::int64_t least_ns = 0, most_ns = 0, seen_ns = 0;
  ClockOffset offset;
  if (!(in >> least_ns >> most_ns >> seen_ns) || least_ns > most_ns) return offset;
  offset.known_ = {Nanoseconds(least_ns), Nanoseconds(most_ns)};
  offset.seen_ = monoFromNs(seen_ns);
  return offset;
}

}  // namespace patina::devices::gphoto2
