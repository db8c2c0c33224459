// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/spawner.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <utility>

namespace patina::daemon {
namespace {

constexpr int kNiceness = -10;
constexpr std::uint64_t kSliceNs = 100'000;  // the shortest the kernel knows

// Of <linux/sched/types.h>, which glibc's headers contradict.
struct SchedulingAttributes {
  std::uint32_t size, policy;
  std::uint64_t flags;
  std::int32_t nice;
  std::uint32_t priority;
  std::uint64_t slice_ns, deadline_ns, period_ns;
};

// For this thread and those it makes. Real-time classes would be stronger than it takes, and a
// driver that spins in one stops the machine. A short slice needs no privilege, and who has one is
// not kept waiting for the slice of another (Linux 6.12; older kernels ignore it).
void stepForward() {
  const auto self = static_cast<id_t>(syscall(SYS_gettid));
  const int now = getpriority(PRIO_PROCESS, self);
  if (sched_getscheduler(0) != SCHED_OTHER) return;  // somebody has decided otherwise
  setpriority(PRIO_PROCESS, self, std::min(now, kNiceness));
  SchedulingAttributes wanted{};
  wanted.size = sizeof wanted;
  wanted.policy = SCHED_OTHER;
  wanted.nice = getpriority(PRIO_PROCESS, self);
  wanted.slice_ns = kSliceNs;
  syscall(SYS_sched_setattr, 0, &wanted, 0);
}

}  // namespace

Spawner::Spawner() : thread_([this] { run(); }) {}

Spawner::~Spawner() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  asked_.notify_one();
  thread_.join();
}

std::thread Spawner::start(std::function<void()> body) {
  std::packaged_task<std::thread()> make([&body] { return std::thread(std::move(body)); });
  auto made = make.get_future();
  {
    const std::lock_guard lock(mutex_);
    wanted_.push_back(std::move(make));
  }
  asked_.notify_one();
  return made.get();
}

void Spawner::run() {
  stepForward();
  std::unique_lock lock(mutex_);
  while (true) {
    asked_.wait(lock, [this] { return ending_ || !wanted_.empty(); });
    if (wanted_.empty()) return;
    auto make = std::move(wanted_.front());
    wanted_.pop_front();
    lock.unlock();
    make();
    lock.lock();
  }
}

}  // namespace patina::daemon
