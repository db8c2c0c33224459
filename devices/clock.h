// SPDX-License-Identifier: GPL-3.0-or-later
// Time is a device. clock.cpp is the one place that may ask the operating system for it.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <utility>

#include "processing/image/units.h"

namespace patina::devices {

enum class Wake { kDue, kStopped };

class Clock {
 public:
  virtual ~Clock() = default;
  virtual UtcTime utc() const = 0;    // may jump
  virtual MonoTime mono() const = 0;  // CLOCK_BOOTTIME: never jumps, counts suspend
  virtual std::string bootId() const = 0;
  // False: every call comes from one thread, and whoever would use more makes its calls there.
  virtual bool threadSafe() const = 0;
  // Returns at `due` (at once when it has passed) or when stop is asked for; stop wins.
  virtual Wake sleepUntil(MonoTime due, std::stop_token stop) = 0;
};

// Thread-safe. sleepUntil wakes on stop within a millisecond; it throws Failure(kTemporary) when
// the process has no file descriptor left, bootId Failure(kUnavailable) without /proc.
class RealClock final : public Clock {
 public:
  UtcTime utc() const override;
  MonoTime mono() const override;
  std::string bootId() const override;
  bool threadSafe() const override { return true; }
  Wake sleepUntil(MonoTime due, std::stop_token stop) override;
};

// One thread only. Sleeping IS advancing. Callbacks planned with `at` fire on the way, in order of
// time and, at equal times, of insertion; they may step the clock, suspend, reboot or ask to stop.
class VirtualClock final : public Clock {
 public:
  explicit VirtualClock(UtcTime utc, MonoTime mono = monoFromNs(1'000'000'000'000),
                        std::string boot_id = "virtual-boot-1");
  UtcTime utc() const override { return utc_; }
  MonoTime mono() const override { return mono_; }
  std::string bootId() const override { return boot_id_; }
  bool threadSafe() const override { return false; }
  Wake sleepUntil(MonoTime due, std::stop_token stop) override;

  void at(MonoTime due, std::function<void()> call);
  void advance(Nanoseconds d);  // as a sleep of d
  void stepUtc(Nanoseconds d);  // NTP, an operator, a missing RTC: mono is untouched
  void suspend(Nanoseconds d);  // both clocks jump; planned callbacks fire late, on resume
  // Planned callbacks keep their hour of the world. No sleeper survives: a sleep from one of whose
  // callbacks this is called returns kStopped.
  void reboot(Nanoseconds off, std::string new_boot_id, MonoTime new_mono);

 private:
  void moveTo(MonoTime due);
  void fireFirst();
  void fireOverdue();

  UtcTime utc_;
  MonoTime mono_;
  std::string boot_id_;
  std::uint64_t inserted_ = 0, boots_ = 0;
  bool firing_ = false;
  std::map<std::pair<MonoTime, std::uint64_t>, std::function<void()>> planned_;
};

}  // namespace patina::devices
