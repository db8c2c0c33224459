// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/clock.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>

#include "devices/suspended.h"
#include "processing/image/failure.h"

namespace patina::devices {
namespace {

constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::int64_t readClockNs(clockid_t id) {
  timespec now{};
  clock_gettime(id, &now);
  return std::int64_t{now.tv_sec} * kNsPerSecond + now.tv_nsec;
}

[[noreturn]] void failSleep(const char* call) {
  throw Failure(Exit::kTemporary, std::string("cannot sleep: ") + call + ": " +
                                      std::strerror(errno) + "; too many open files?");
}

class Descriptor {
 public:
  Descriptor(int fd, const char* call) : fd_(fd) {
    if (fd_ < 0) failSleep(call);
  }
  ~Descriptor() { close(fd_); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int fd() const { return fd_; }

 private:
  int fd_;
};

// Made once a thread, so that a run of days cannot fail to sleep for want of descriptors. A timer
// on CLOCK_BOOTTIME, since no condition variable waits on it and the others stand still in suspend;
// it is exempt from timer slack too.
class Sleeper {
 public:
  Wake sleepUntil(MonoTime due, const std::stop_token& stop) {
    arm(due);
    const std::stop_callback on_stop(stop, [this] {
      const std::uint64_t one = 1;
      [[maybe_unused]] const auto n = write(stopped_.fd(), &one, sizeof one);
    });
    pollfd fds[2] = {{timer_.fd(), POLLIN, 0}, {stopped_.fd(), POLLIN, 0}};
    while (poll(fds, 2, -1) < 0) {
      if (errno != EINTR) failSleep("poll");
    }
    return stop.stop_requested() ? Wake::kStopped : Wake::kDue;
  }

  // What an earlier sleep left behind, read after its callback is gone.
  void drain() {
    std::uint64_t count = 0;
    while (read(stopped_.fd(), &count, sizeof count) > 0) continue;
  }

 private:
  void arm(MonoTime due) {
    itimerspec when{};
    when.it_value.tv_sec = toNs(due) / kNsPerSecond;
    when.it_value.tv_nsec = toNs(due) % kNsPerSecond;
    if (timerfd_settime(timer_.fd(), TFD_TIMER_ABSTIME, &when, nullptr) != 0) {
      failSleep("timerfd_settime");
    }
  }

  Descriptor timer_{timerfd_create(CLOCK_BOOTTIME, TFD_CLOEXEC | TFD_NONBLOCK), "timerfd_create"};
  Descriptor stopped_{eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK), "eventfd"};
};

}  // namespace

UtcTime RealClock::utc() const { return utcFromNs(readClockNs(CLOCK_REALTIME)); }

MonoTime RealClock::mono() const { return monoFromNs(readClockNs(CLOCK_BOOTTIME)); }

std::string RealClock::bootId() const {
  std::ifstream file("/proc/sys/kernel/random/boot_id");
  std::string id;
  // Without it a reboot could pass for the same boot, and every deadline would be wrong.
  if (!std::getline(file, id) || id.empty()) {
    throw Failure(Exit::kUnavailable,
                  "/proc/sys/kernel/random/boot_id cannot be read: is /proc mounted?");
  }
  return id;
}

Wake RealClock::sleepUntil(MonoTime due, std::stop_token stop) {
  if (stop.stop_requested()) return Wake::kStopped;
  if (due <= mono()) return Wake::kDue;
  thread_local Sleeper sleeper;
  sleeper.drain();
  return sleeper.sleepUntil(due, stop);
}

Nanoseconds sleptSinceBoot() {
  // The one read in the middle of two, so that being put aside between them does not count.
  const std::int64_t before = readClockNs(CLOCK_MONOTONIC);
  const std::int64_t boot = readClockNs(CLOCK_BOOTTIME);
  const std::int64_t after = readClockNs(CLOCK_MONOTONIC);
  return Nanoseconds{boot - before - (after - before) / 2};
}

VirtualClock::VirtualClock(UtcTime utc, MonoTime mono, std::string boot_id)
    : utc_(utc), mono_(mono), boot_id_(std::move(boot_id)) {}

Wake VirtualClock::sleepUntil(MonoTime due, std::stop_token stop) {
  const std::uint64_t boot = boots_;
  while (!stop.stop_requested()) {
    if (planned_.empty() || planned_.begin()->first.first > std::max(due, mono_)) {
      moveTo(due);
      return Wake::kDue;
    }
    fireFirst();
    if (boots_ != boot) return Wake::kStopped;
  }
  return Wake::kStopped;
}

void VirtualClock::at(MonoTime due, std::function<void()> call) {
  planned_.emplace(std::pair(due, inserted_++), std::move(call));
}

void VirtualClock::advance(Nanoseconds d) { sleepUntil(mono_ + d, {}); }

void VirtualClock::stepUtc(Nanoseconds d) { utc_ += d; }

void VirtualClock::suspend(Nanoseconds d) {
  moveTo(mono_ + d);
  fireOverdue();
}

void VirtualClock::reboot(Nanoseconds off, std::string new_boot_id, MonoTime new_mono) {
  const Nanoseconds shift = new_mono - (mono_ + off);
  utc_ += off;
  mono_ = new_mono;
  boot_id_ = std::move(new_boot_id);
  ++boots_;
  // The world outside does not restart with the machine: what was planned keeps its hour.
  decltype(planned_) planned;
  for (auto& [key, call] : planned_) {
    planned.emplace(std::pair(key.first + shift, key.second), std::move(call));
  }
  planned_ = std::move(planned);
  fireOverdue();
}

void VirtualClock::moveTo(MonoTime due) {
  if (due <= mono_) return;
  utc_ += due - mono_;
  mono_ = due;
}

void VirtualClock::fireFirst() {
  auto first = planned_.extract(planned_.begin());
  moveTo(first.key().first);
  const bool outer = std::exchange(firing_, true);
  try {
    first.mapped()();
  } catch (...) {
    firing_ = outer;
    throw;
  }
  firing_ = outer;
}

// Inside a callback the sleep that called it goes on firing, after that callback has ended.
void VirtualClock::fireOverdue() {
  while (!firing_ && !planned_.empty() && planned_.begin()->first.first <= mono_) fireFirst();
}

}  // namespace patina::devices
