// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/service.h"

#include <systemd/sd-daemon.h>

#include <algorithm>

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kUnasked = 15s;

// Control characters would begin a variable of their own.
std::string oneLine(std::string text) {
  std::replace_if(
      text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
  return text;
}

}  // namespace

void notifyReady(const std::string& status) {
  sd_notify(0, ("READY=1\nSTATUS=" + oneLine(status)).c_str());
}
void notifyStatus(const std::string& status) {
  sd_notify(0, ("STATUS=" + oneLine(status)).c_str());
}
void notifyStopping() { sd_notify(0, "STOPPING=1\nSTATUS=finishing the frames"); }

Watchdog::Watchdog(devices::Clock& clock) : clock_(clock), patience_(kUnasked) {
  std::uint64_t patience_us = 0;
  if (sd_watchdog_enabled(0, &patience_us) <= 0) return;
  asked_ = true;
  patience_ = std::min<Nanoseconds>(std::chrono::microseconds(patience_us) / 2, kUnasked);
}

void Watchdog::begin(const std::string& loop) {
  const std::lock_guard lock(mutex_);
  loops_.insert(loop);
  waiting_for_.insert(loop);
}

void Watchdog::end(const std::string& loop) {
  const std::lock_guard lock(mutex_);
  loops_.erase(loop);
  waiting_for_.erase(loop);
}

void Watchdog::turned(const std::string& loop) {
  if (!asked_) return;
  const std::lock_guard lock(mutex_);
  waiting_for_.erase(loop);
  if (!waiting_for_.empty()) return;
  // Loops of milliseconds need no datagram each.
  const MonoTime now = clock_.mono();
  if (now - pinged_ < patience_ / 4) return;
  sd_notify(0, "WATCHDOG=1");
  pinged_ = now;
  waiting_for_ = loops_;
}

}  // namespace patina::daemon
