// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "devices/clock.h"

namespace patina::devices {

// A clock that runs `speed` times as fast as the one below it, for rehearsing days in an hour with
// every thread and descriptor of the real thing. It keeps nothing: mono is the other's times speed,
// utc starts where the machine was booted, so a process that starts again finds the time that went
// by. As thread-safe as the clock below, which must outlive it.
class ScaledClock final : public Clock {
 public:
  // speed from 1 to 1000. Failure(kUsage) when this boot is so old that utc would leave its range.
  ScaledClock(Clock& real, double speed);
  UtcTime utc() const override;
  MonoTime mono() const override;
  std::string bootId() const override;  // another than the real one: the grids do not mix
  bool threadSafe() const override { return real_.threadSafe(); }
  Wake sleepUntil(MonoTime due, std::stop_token stop) override;

 private:
  Clock& real_;
  double speed_;
};

}  // namespace patina::devices
