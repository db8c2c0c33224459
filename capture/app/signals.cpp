// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/signals.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <utility>

namespace patina::app {
namespace {

volatile std::sig_atomic_t signals_pipe = -1;

// A handler, not a mask with signalfd: OpenBLAS starts threads before main(), no mask of ours
// reaches those, and a signal that finds such a thread would end the process.
void pass(int number) {
  const auto byte = static_cast<unsigned char>(number);
  if (write(signals_pipe, &byte, 1) != 1) _exit(128 + number);
}

}  // namespace

Signals::Signals() {
  std::signal(SIGPIPE, SIG_IGN);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) std::abort();
  signals_fd_ = ends[0];
  signals_pipe = ends[1];
  struct sigaction action {};
  action.sa_handler = pass;
  action.sa_flags = SA_RESTART;
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) sigaction(number, &action, nullptr);
  quit_fd_ = eventfd(0, EFD_CLOEXEC);
  thread_ = std::thread([this] { run(); });
}

Signals::~Signals() {
  const std::uint64_t one = 1;
  if (write(quit_fd_, &one, sizeof one) != sizeof one) std::abort();
  thread_.join();
  for (const int number : {SIGINT, SIGTERM, SIGUSR1}) std::signal(number, SIG_DFL);
  close(signals_pipe);
  close(quit_fd_);
  close(signals_fd_);
}

void Signals::onStop(std::function<void()> call) {
  const std::lock_guard lock(mutex_);
  on_stop_ = std::move(call);
  if (received_ != 0 && on_stop_) on_stop_();
}

void Signals::onReload(std::function<void()> call) {
  const std::lock_guard lock(mutex_);
  on_reload_ = std::move(call);
  struct sigaction action {};
  action.sa_handler = on_reload_ ? pass : SIG_DFL;
  action.sa_flags = SA_RESTART;
  sigaction(SIGHUP, &action, nullptr);
}

void Signals::run() {
  pollfd fds[] = {{signals_fd_, POLLIN, 0}, {quit_fd_, POLLIN, 0}};
  for (;;) {
    if (poll(fds, 2, -1) < 0) continue;
    if (fds[1].revents != 0) return;
    unsigned char number = 0;
    if (read(signals_fd_, &number, 1) != 1) continue;
    if (number == SIGUSR1) {
      shoot_now_ = true;
      continue;
    }
    if (number == SIGHUP) {
      const std::lock_guard lock(mutex_);
      if (on_reload_) on_reload_();
      continue;
    }
    // Nothing half-written carries a final name, and the archive recovers: leaving is safe.
    if (received_.exchange(number) != 0) _exit(128 + number);
    const std::lock_guard lock(mutex_);
    if (on_stop_) on_stop_();
  }
}

}  // namespace patina::app
