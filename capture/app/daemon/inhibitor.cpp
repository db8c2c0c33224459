// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/inhibitor.h"

#include <fcntl.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#include <cstring>

namespace patina::daemon {
namespace {

constexpr std::uint64_t kPatienceUs = 5'000'000;

// The lock's descriptor, or -errno; `why` in words.
int inhibit(std::string& why) {
  sd_bus* bus = nullptr;
  sd_bus_error error{};  // SD_BUS_ERROR_NULL is C
  sd_bus_message* reply = nullptr;
  int lock = sd_bus_open_system(&bus);
  if (lock >= 0) lock = sd_bus_set_method_call_timeout(bus, kPatienceUs);
  if (lock >= 0)
    lock = sd_bus_call_method(bus, "org.freedesktop.login1", "/org/freedesktop/login1",
                              "org.freedesktop.login1.Manager", "Inhibit", &error, &reply, "ssss",
                              "sleep:idle", "Patina", "a run is being captured", "block");
  int borrowed = -1;
  if (lock >= 0) lock = sd_bus_message_read(reply, "h", &borrowed);
  // The message owns its descriptor: ours is a copy.
  if (lock >= 0) lock = fcntl(borrowed, F_DUPFD_CLOEXEC, 3);
  if (lock < 0) why = error.message != nullptr ? error.message : std::strerror(-lock);
  sd_bus_error_free(&error);
  sd_bus_message_unref(reply);
  sd_bus_flush_close_unref(bus);
  return lock;
}

}  // namespace

std::string Inhibitor::take() {
  if (held() || refused_) return {};
  std::string why;
  lock_ = inhibit(why);
  if (held()) return {};
  lock_ = -1;
  refused_ = true;
  return "the machine may fall asleep during a run, since logind does not answer (" + why +
         "): see that suspend is off";
}

void Inhibitor::release() {
  if (held()) close(lock_);
  lock_ = -1;
}

}  // namespace patina::daemon
