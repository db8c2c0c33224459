// SPDX-License-Identifier: GPL-3.0-or-later
// A descriptor that becomes readable at a time of a Clock: the camera's time in a poll() of
// sockets.
#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "devices/clock.h"

namespace patina::devices::twin::dslr {

// The clock must be thread-safe. Thread-safe itself.
class DueSignal {
 public:
  explicit DueSignal(Clock& clock);  // Failure(kTemporary) without descriptors
  ~DueSignal();
  DueSignal(const DueSignal&) = delete;
  DueSignal& operator=(const DueSignal&) = delete;

  void arm(std::optional<MonoTime> due);  // in place of the time before; none: never
  void wake();                            // now
  int fd() const { return fd_; }
  void clear();  // what it said so far

 private:
  void run(const std::stop_token& stop);

  Clock& clock_;
  int fd_;
  std::mutex mutex_;  // guards due_, sleep_
  std::condition_variable_any changed_;
  std::optional<MonoTime> due_;
  std::stop_source sleep_;  // of the sleep that is under way
  std::jthread thread_;
};

}  // namespace patina::devices::twin::dslr
