// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/signals.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <utility>

namespace patina::app {

Signals::Signals() {
  std::signal(SIGPIPE, SIG_IGN);
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGINT);
  sigaddset(&set, SIGTERM);
  sigaddset(&set, SIGUSR1);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
  signals_fd_ = signalfd(-1, &set, SFD_CLOEXEC);
  quit_fd_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { run(); });
}

Signals::~Signals() {
  const std::uint64_t one = 1;
  if (write(quit_fd_, &one, sizeof one) != sizeof one) std::abort();
  thread_.join();
  close(quit_fd_);
  close(signals_fd_);
}

void Signals::onStop(std::function<void()> call) {
  const std::lock_guard lock(mutex_);
  on_stop_ = std::move(call);
  if (received_ != 0 && on_stop_) on_stop_();
}

void Signals::run() {
  pollfd fds[] = {{signals_fd_, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
  for (;;) {
    if (poll(fds, 2, -1) < 0) continue;
    if (fds[1].revents != 0) return;
    signalfd_siginfo info{};
    if (read(signals_fd_, &info, sizeof info) != sizeof info) continue;
    const int number = static_cast<int>(info.ssi_signo);
    if (number == SIGUSR1) {
      shoot_now_ = true;
      continue;
    }
    // Nothing half-written carries a final name, and the archive recovers: leaving is safe.
    if (received_.exchange(number) != 0) _exit(128 + number);
    const std::lock_guard lock(mutex_);
    if (on_stop_) on_stop_();
  }
}

}  // namespace patina::app
