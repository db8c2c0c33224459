// SPDX-License-Identifier: GPL-3.0-or-later
// One unfinished run: its files, its thread, and what was asked of it. Internal to the keeper.
#pragma once

#include <atomic>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>

#include "capture/app/daemon/run_files.h"
#include "capture/app/daemon/run_view.h"
#include "capture/app/daemon/spawner.h"

namespace patina::daemon {

class ActiveRun {
 public:
  ActiveRun(RunObserver& observer, Spawner& spawner, const db::RunRow& run,
            std::filesystem::path plan);
  ~ActiveRun();  // stops and joins
  ActiveRun(const ActiveRun&) = delete;
  ActiveRun& operator=(const ActiveRun&) = delete;

  // The calls of one thread at a time (the keeper's lock): begin, join.
  // `session` runs on a thread of its own with the hooks it is given; what it throws is its own.
  void begin(std::function<void(ActiveRun&, const capture::SessionHooks&)> session);
  void join();  // of a session that has ended or was asked to

  // Any thread.
  void askToPause(bool paused) { paused_ = paused; }
  void askForShot() { shoot_ = true; }
  void askToStop();
  void askToAbort();
  bool working() const { return working_; }
  bool stopping() const { return working_ && stopping_; }
  RunView view() const;
  void setState(const std::string& state);
  bool setTrouble(const std::string& trouble);  // false: it was the last one too
  void setDevices(std::vector<std::string> devices);

  const std::string& id() const { return run_.id; }
  const db::RunRow& row() const { return run_; }
  const std::filesystem::path& plan() const { return plan_; }

 private:
  capture::SessionHooks hooks();
  void take(const capture::SessionStatus& status);
  void take(const db::ShotRow& shot);
  void take(const db::FrameRow& frame);

  RunObserver& observer_;
  Spawner& spawner_;
  const db::RunRow run_;
  const std::filesystem::path plan_;
  std::atomic<bool> paused_{false}, shoot_{false}, working_{false}, stopping_{false};
  std::stop_source stop_, abort_;
  std::string shot_by_;       // the camera of the shot that was settled last; the session's thread
  mutable std::mutex mutex_;  // guards what follows
  RunView view_;
  std::string told_trouble_;
  std::thread thread_;
};

}  // namespace patina::daemon
