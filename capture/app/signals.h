// SPDX-License-Identifier: GPL-3.0-or-later
// SIGINT, SIGTERM, SIGUSR1 and SIGHUP as ordinary calls on a thread of their own.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

namespace patina::app {

// One at a time, in main().
// SIGPIPE is ignored: a reader that goes away is an error of the write, not a death.
class Signals {
 public:
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // What SIGINT or SIGTERM does the first time. A second one ends the process at once.
  void onStop(std::function<void()> call);
  // What SIGHUP does; without it, SIGHUP ends the process as it always did.
  void onReload(std::function<void()> call);
  std::atomic<bool>& shootNow() { return shoot_now_; }  // SIGUSR1
  int received() const { return received_; }            // the number of the signal; 0: none

 private:
  void run();
  int signals_fd_ = -1, quit_fd_ = -1;
  std::atomic<bool> shoot_now_{false};
  std::atomic<int> received_{0};
  std::mutex mutex_;
  std::function<void()> on_stop_, on_reload_;
  std::thread thread_;
};

}  // namespace patina::app
