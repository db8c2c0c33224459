// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the threads that capture. A thread has the priority of the one that makes it, and a run may
// be started by a handler of HTTP, which has given its own up for good: without privileges nobody
// takes it back. So they are all made by one thread that was there before.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace patina::daemon {

class Spawner {
 public:
  // Its threads have the priority of the caller, or nice -10 where we may, and short slices: then a
  // busy machine wakes them first. So have the workers of cameras, which sessions make.
  Spawner();
  ~Spawner();  // its threads go on
  Spawner(const Spawner&) = delete;
  Spawner& operator=(const Spawner&) = delete;

  // Any thread. std::system_error when the system has no thread left.
  std::thread start(std::function<void()> body);

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable asked_;
  std::deque<std::packaged_task<std::thread()>> wanted_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace patina::daemon
