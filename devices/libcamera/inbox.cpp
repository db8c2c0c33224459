// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/inbox.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "processing/image/failure.h"

namespace patina::devices::libcamera {

using namespace std::chrono_literals;

Inbox::Inbox() : bell_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (bell_ < 0) throw Failure(Exit::kTemporary, "no file descriptor left for a camera");
}

Inbox::~Inbox() { ::close(bell_); }

void Inbox::add(std::uint64_t number) {
  {
    const std::lock_guard lock(mutex_);
    numbers_.push_back(number);
  }
  ring();
}

void Inbox::lose() {
  lost_ = true;
  ring();
}

void Inbox::clear() {
  const std::lock_guard lock(mutex_);
  numbers_.clear();
}

std::optional<std::uint64_t> Inbox::next(Clock& clock, MonoTime deadline) {
  while (!lost_) {
    if (const auto number = take()) return number;
    const Nanoseconds left = deadline - clock.mono();
    if (left <= 0ns) break;
    pollfd wait{bell_, POLLIN, 0};
    const auto ms = std::chrono::ceil<std::chrono::milliseconds>(std::min<Nanoseconds>(left, 60s));
    ::poll(&wait, 1, static_cast<int>(ms.count()));
  }
  return std::nullopt;
}

std::optional<std::uint64_t> Inbox::take() {
  std::uint64_t rung = 0;
  [[maybe_unused]] const auto got = ::read(bell_, &rung, sizeof rung);
  const std::lock_guard lock(mutex_);
  if (numbers_.empty()) return std::nullopt;
  const std::uint64_t first = numbers_.front();
  numbers_.pop_front();
  return first;
}

void Inbox::ring() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto put = ::write(bell_, &one, sizeof one);
}

}  // namespace patina::devices::libcamera
