// SPDX-License-Identifier: GPL-3.0-or-later
// What systemd wants to know of a service: that it is ready, what it does, and that it lives. All
// of it is silence when nobody started us that asks ($NOTIFY_SOCKET).
#pragma once

#include <mutex>
#include <set>
#include <string>

#include "devices/clock.h"

namespace patina::daemon {

void notifyReady(const std::string& status);
void notifyStatus(const std::string& status);
void notifyStopping();

// Pings the watchdog only when every loop at work has turned since the last ping: the main loop and
// the loops of all sessions. A timer of its own would ping while a session hangs. Thread-safe.
class Watchdog {
 public:
  // `clock` is the real one: systemd's patience is real time.
  explicit Watchdog(devices::Clock& clock);

  void begin(const std::string& loop);  // a loop is at work from now on
  void end(const std::string& loop);
  void turned(const std::string& loop);  // pings when it was the last; also from unknown loops
  // How long the main loop may sleep: half of the patience; 15 s when nobody asks.
  Nanoseconds patience() const { return patience_; }

 private:
  devices::Clock& clock_;
  Nanoseconds patience_;
  bool asked_ = false;
  std::mutex mutex_;
  std::set<std::string> loops_, waiting_for_;
  MonoTime pinged_;
};

}  // namespace patina::daemon
