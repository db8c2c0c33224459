// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/network/freshness.h"

namespace patina::devices::network {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kResolution = 1s;  // of dates in HTTP

}  // namespace

void Freshness::learn(const HttpReply& reply, UtcTime utc, MonoTime mono) {
  has_clock_ = reply.date.has_value();
  // A camera that does not date its answers is taken to have our time.
  camera_ahead_ = has_clock_ ? reply.date->time_since_epoch() - reply.first_byte.time_since_epoch()
                             : utc.time_since_epoch() - mono.time_since_epoch();
}

// Dates are cut to whole seconds: the latest that it can have been. The camera's clock may be up to
// a second further ahead than was learned, which makes it earlier still.
MonoTime Freshness::latestOf(UtcTime by_camera) const {
  return MonoTime{by_camera.time_since_epoch() + kResolution - camera_ahead_};
}

std::string Freshness::whyStale(const HttpReply& reply, MonoTime trigger) const {
  if (last_ && sha256(reply.body) == *last_) return "the previous picture came again";
  if (reply.age > 0ns && reply.first_byte - reply.age + kResolution < trigger)
    return "it lay in a cache for " + formatDuration(reply.age);
  if (reply.last_modified && latestOf(*reply.last_modified) < trigger)
    return "it was modified before the trigger, at " + formatUtc(*reply.last_modified) +
           " of the camera's clock";
  if (has_clock_ && reply.date && latestOf(*reply.date) < trigger)
    return "it is dated before the trigger, " + formatUtc(*reply.date) + " of the camera's clock";
  return {};
}

}  // namespace patina::devices::network
