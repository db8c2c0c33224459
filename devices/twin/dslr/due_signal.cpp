// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/due_signal.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <cstdint>
#include <utility>

#include "processing/image/failure.h"

namespace patina::devices::twin::dslr {

DueSignal::DueSignal(Clock& clock) : clock_(clock), fd_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  PATINA_CHECK(clock.threadSafe());
  if (fd_ < 0) throw Failure(Exit::kTemporary, "no eventfd: too many open files?");
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

DueSignal::~DueSignal() {
  thread_.request_stop();
  {
    const std::lock_guard lock(mutex_);
    sleep_.request_stop();
  }
  thread_.join();
  close(fd_);
}

void DueSignal::arm(std::optional<MonoTime> due) {
  const std::lock_guard lock(mutex_);
  if (due_ == due) return;
  due_ = due;
  sleep_.request_stop();
  changed_.notify_one();
}

void DueSignal::wake() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const auto n = write(fd_, &one, sizeof one);  // full: it is readable anyway
}

void DueSignal::clear() {
  std::uint64_t count = 0;
  [[maybe_unused]] const auto n = read(fd_, &count, sizeof count);
}

void DueSignal::run(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (!stop.stop_requested()) {
    if (!changed_.wait(lock, stop, [this] { return due_.has_value(); })) return;
    const MonoTime due = *due_;
    sleep_ = std::stop_source();
    const std::stop_token sleep = sleep_.get_token();
    if (stop.stop_requested()) return;
    lock.unlock();
    const Wake woken = clock_.sleepUntil(due, sleep);
    lock.lock();
    if (woken == Wake::kStopped || due_ != due) continue;
    due_.reset();
    wake();
  }
}

}  // namespace patina::devices::twin::dslr
