// SPDX-License-Identifier: GPL-3.0-or-later
// The [after] steps of finished runs, one run at a time, each in a process of its own at the lowest
// priority: what they need in memory and time, or how they die, is no matter of capture's.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace patina::daemon {

class AfterWork {
 public:
  // `command` with the id of the run behind it; `command[0]` is a path. `done` is called with what
  // became of it ("" = it is done, else why not), on a thread of ours.
  AfterWork(std::vector<std::string> command,
            std::function<void(const std::string& run_id, const std::string& trouble)> done);
  ~AfterWork();  // ends the process at work; what is left is for the next start

  void add(const std::string& run_id);  // returns at once; one that waits already counts once
  std::size_t waiting() const;          // the one at work included

 private:
  void run();
  std::string make(const std::string& run_id);

  std::vector<std::string> command_;
  std::function<void(const std::string&, const std::string&)> done_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::string> queue_;
  bool ending_ = false;
  int child_ = 0;
  std::thread thread_;
};

}  // namespace patina::daemon
