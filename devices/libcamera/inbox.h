// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers of requests that are complete, from the library's thread to the camera's.
#pragma once

#include <atomic>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "devices/clock.h"

namespace patina::devices::libcamera {

class Inbox {  // Thread-safe; one reader.
 public:
  Inbox();  // throws Failure(kTemporary) when the process has no file descriptor left
  ~Inbox();
  Inbox(const Inbox&) = delete;
  Inbox& operator=(const Inbox&) = delete;

  void add(std::uint64_t number);
  void lose();  // the camera is gone: whoever waits wakes up, now and later
  bool lost() const { return lost_; }
  void clear();
  // The oldest; nothing at the deadline or when the camera is lost.
  std::optional<std::uint64_t> next(Clock& clock, MonoTime deadline);

 private:
  std::optional<std::uint64_t> take();
  void ring();

  int bell_;
  std::atomic<bool> lost_ = false;
  std::mutex mutex_;
  std::deque<std::uint64_t> numbers_;  // guarded by mutex_
};

}  // namespace patina::devices::libcamera
