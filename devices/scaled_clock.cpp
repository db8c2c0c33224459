// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/scaled_clock.h"

#include <cmath>

#include "processing/image/failure.h"

namespace patina::devices {

ScaledClock::ScaledClock(Clock& real, double speed) : real_(real), speed_(speed) {
  constexpr double kYearsMax = 200;  // utc in nanoseconds ends in 2262
  const double years = toSeconds(real.mono().time_since_epoch()) * speed / (365.25 * 86400);
  if (!(speed >= 1 && speed <= 1000) || years > kYearsMax)
    throw Failure(Exit::kUsage, "time cannot run " + std::to_string(speed) +
                                    " times as fast: the speed is 1 to 1000, and less the longer "
                                    "ago the machine was booted");
}

MonoTime ScaledClock::mono() const {
  const auto real = static_cast<double>(toNs(real_.mono()));
  return monoFromNs(static_cast<std::int64_t>(real * speed_));
}

UtcTime ScaledClock::utc() const {
  const MonoTime real = real_.mono();
  const UtcTime booted = real_.utc() - real.time_since_epoch();
  return booted + Nanoseconds(static_cast<std::int64_t>(static_cast<double>(toNs(real)) * speed_));
}

std::string ScaledClock::bootId() const {
  return real_.bootId() + "-x" + std::to_string(std::llround(speed_ * 1000)) + "e-3";
}

Wake ScaledClock::sleepUntil(MonoTime due, std::stop_token stop) {
  // Rounded up, so that the due time has come when this returns.
  const double real = std::ceil(static_cast<double>(toNs(due)) / speed_) + 1;
  return real_.sleepUntil(monoFromNs(static_cast<std::int64_t>(real)), std::move(stop));
}

}  // namespace patina::devices
