// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/spawner.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <utility>

namespace patina::daemon {
namespace {

constexpr int kNiceness = -10;

// For this thread and those it makes. Real-time classes would be stronger than it takes, and a
// driver that spins in one stops the machine.
void stepForward() {
  const auto self = static_cast<id_t>(syscall(SYS_gettid));
  if (getpriority(PRIO_PROCESS, self) > kNiceness) setpriority(PRIO_PROCESS, self, kNiceness);
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
