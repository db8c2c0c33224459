// SPDX-License-Identifier: GPL-3.0-or-later
// Waiting for the world outside, which knows no virtual time: a descriptor, or a call from another
// thread, with a limit that a timer of the system keeps.
#pragma once

#include <stop_token>

#include "processing/image/units.h"

namespace patina::capture::notify {

enum class Waited { kReady, kTooLong, kHurry };

class Wait {
 public:
  // The limit begins now. NotifyError(kTemporary) when there is no descriptor left.
  explicit Wait(Nanoseconds limit);
  ~Wait();
  Wait(const Wait&) = delete;
  Wait& operator=(const Wait&) = delete;

  Waited untilReadable(int fd, const std::stop_token& hurry);

 private:
  int timer_ = -1, hurried_ = -1;
};

// Something that one thread says and another waits for, any number of times.
class Bell {
 public:
  Bell();
  ~Bell();
  Bell(const Bell&) = delete;
  Bell& operator=(const Bell&) = delete;
  void ring() const;
  void hush() const;
  int fd() const { return fd_; }

 private:
  int fd_;
};

}  // namespace patina::capture::notify
