// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/wait.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>

#include "capture/notify/notifier.h"

namespace patina::capture::notify {
namespace {

void ringDescriptor(int fd) {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = write(fd, &one, sizeof one);
}

int checked(int fd) {
  if (fd < 0) throw NotifyError(Exit::kTemporary, "no file descriptor is left to wait with");
  return fd;
}

int newBell() { return checked(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)); }

}  // namespace

Wait::Wait(Nanoseconds limit)
    : timer_(checked(timerfd_create(CLOCK_BOOTTIME, TFD_CLOEXEC | TFD_NONBLOCK))) {
  itimerspec when{};
  when.it_value.tv_sec = limit.count() / 1'000'000'000;
  when.it_value.tv_nsec = limit.count() % 1'000'000'000;
  timerfd_settime(timer_, 0, &when, nullptr);
  hurried_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  if (hurried_ >= 0) return;
  close(timer_);
  checked(hurried_);
}

Wait::~Wait() {
  close(timer_);
  close(hurried_);
}

Waited Wait::untilReadable(int fd, const std::stop_token& hurry) {
  const std::stop_callback on_hurry(hurry, [this] { ringDescriptor(hurried_); });
  pollfd fds[] = {{fd, POLLIN, 0}, {timer_, POLLIN, 0}, {hurried_, POLLIN, 0}};
  while (poll(fds, 3, -1) < 0 && errno == EINTR) continue;
  if (fds[0].revents != 0) return Waited::kReady;
  return fds[2].revents != 0 ? Waited::kHurry : Waited::kTooLong;
}

Bell::Bell() : fd_(newBell()) {}

Bell::~Bell() { close(fd_); }

void Bell::ring() const { ringDescriptor(fd_); }

void Bell::hush() const {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto n = read(fd_, &count, sizeof count);
}

}  // namespace patina::capture::notify
