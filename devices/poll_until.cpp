// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/poll_until.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace patina::devices {

Polled pollUntil(int fd, short events, const Clock& clock, MonoTime deadline) {
  while (true) {
    const Nanoseconds left = std::max(deadline - clock.mono(), Nanoseconds{0});
    const auto seconds = std::chrono::floor<std::chrono::seconds>(left);
    const timespec timeout{seconds.count(), (left - seconds).count()};
    pollfd one{fd, events, 0};
    const int n = ppoll(&one, 1, &timeout, nullptr);
    if (n == 0) return Polled::kTimeout;
    if (n < 0 && errno == EINTR) continue;
    if (n > 0 && (one.revents & events) != 0) return Polled::kReady;
    return Polled::kHungUp;
  }
}

}  // namespace patina::devices
