// SPDX-License-Identifier: GPL-3.0-or-later
// A clock that stands still until a test moves it, for code with threads of its own.
#pragma once

#include <condition_variable>
#include <mutex>

#include "devices/clock.h"

namespace patina::http {

class ManualClock final : public devices::Clock {
 public:
  UtcTime utc() const override { return utcFromNs(toNs(mono())); }
  MonoTime mono() const override {
    const std::lock_guard lock(mutex_);
    return now_;
  }
  std::string bootId() const override { return "manual"; }
  bool threadSafe() const override { return true; }
  devices::Wake sleepUntil(MonoTime due, std::stop_token stop) override {
    const std::stop_callback wake(stop, [this] {
      const std::lock_guard lock(mutex_);
      moved_.notify_all();
    });
    std::unique_lock lock(mutex_);
    moved_.wait(lock, [&] { return stop.stop_requested() || now_ >= due; });
    return stop.stop_requested() ? devices::Wake::kStopped : devices::Wake::kDue;
  }

  void advance(Nanoseconds d) {
    const std::lock_guard lock(mutex_);
    now_ += d;
    moved_.notify_all();
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable moved_;
  MonoTime now_ = monoFromNs(1'000'000'000'000);
};

}  // namespace patina::http
