// SPDX-License-Identifier: GPL-3.0-or-later
// Keeps the runs of one archive going: one thread a run, several at once when no two use the same
// camera or lamp. What a person asks for is written into the archive before it is acted on, so that
// it holds over a death and a restart: a paused run stays paused, a stopped one stays stopped.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "capture/app/daemon/run_files.h"
#include "capture/app/daemon/run_view.h"
#include "capture/app/daemon/spawner.h"
#include "capture/notify/dispatcher.h"
#include "db/archive.h"
#include "devices/clock.h"

namespace patina::daemon {

class ActiveRun;

struct KeeperOptions {
  db::Archive& archive;
  devices::Clock& clock;
  RunObserver& observer;
  // On the run's own thread, where its devices live and die. openRig() but in tests.
  std::function<devices::Rig(const RunFiles&, const capture::RunStart&, devices::Clock&)> open_rig;
  // Throws when a camera that a new run needs is not there; null: nobody looks. On the asker's
  // thread.
  std::function<void(const devices::RigSpec&, devices::Clock&)> require_cameras;
  // Tells people what their plans ask to be told; null: nobody. Outlives us.
  capture::notify::Dispatcher* dispatcher = nullptr;
  // A step of a run was captured whose plan makes something of each. Returns at once. On the run's
  // thread.
  std::function<void(const std::string& run_id)> stepped;
  // A run is finished: its products are due. Returns at once. On the run's thread.
  std::function<void(const std::string& run_id)> finished;
};

struct StartOptions {
  bool new_run = false;
  bool wait = false;  // begin although a camera is not there
};

// Thread-safe. Archive, clock and observer outlive it. Throws capture::CaptureError,
// db::ArchiveError, devices::ConfigError; then nothing has changed.
class RunKeeper {
 public:
  // Sessions have the priority of this thread, or a better one (spawner.h).
  explicit RunKeeper(KeeperOptions options);
  ~RunKeeper();  // as shutDown()

  // What a dead daemon left behind goes on: running and paused runs. One that cannot (a file or a
  // device is not there) says so in its view and is tried again by retry().
  void takeUp();
  void retry();

  // A new run, or the unfinished one of the very same plan, which may be going on already.
  // kTemporary, naming the other run, when that holds a device this one needs; kUnavailable when a
  // camera of a new run is not there.
  RunView start(const std::filesystem::path& plan, const StartOptions& how);
  // Each may be asked for again. `run` is an id, a unique prefix, or "latest". kUsage when the run
  // has ended.
  RunView pause(const std::string& run);   // at the next step; what falls due is skipped
  RunView resume(const std::string& run);  // a stopped one too
  RunView stop(const std::string& run);    // after the frame; until it is started again
  RunView abort(const std::string& run);   // in the middle of a step; for ever
  RunView shoot(const std::string& run);   // one step now, between those of the plan

  std::vector<RunView> runs() const;  // the unfinished ones that are not stopped
  // The disk failed under the archive: nothing can be written until the process starts again.
  bool broken() const;
  // Sessions end after their frames; their runs are as they were, and go on with takeUp().
  void shutDown();

 private:
  using Run = std::shared_ptr<ActiveRun>;
  void sweep();
  db::RunRow rowOf(const std::string& run) const;
  db::RunRow ownRow(const std::string& run) const;  // of a run that was captured
  Run find(const std::string& id) const;
  Run adopt(const db::RunRow& row);
  // What start() is to begin; `going`: is at work already.
  struct Admitted {
    RunFiles files, claimed;  // the plan's, and what it uses of its rig
    std::string unfinished;   // the run of the very same plan; empty: a new one
    std::optional<RunView> going;
  };
  Admitted admit(const std::filesystem::path& plan, bool new_run);
  void refuseOverlap(const RunFiles& files, const std::string& own_id) const;
  void launch(const Run& run, const RunFiles& files, const capture::RunStart& start);
  void tryToLaunch(const Run& run);
  void session(ActiveRun& run, const RunFiles& files, const capture::RunStart& start,
               const capture::SessionHooks& hooks);
  void shootPlan(ActiveRun& run, const RunFiles& files, const capture::RunStart& start,
                 capture::SessionHooks hooks);
  void note(const std::string& run_id, const std::string& kind, const std::string& detail);
  void trouble(ActiveRun& run, const std::string& what);
  std::filesystem::path planOf(const std::string& run_id) const;
  RunView viewOf(const db::RunRow& row) const;
  RunView endBy(const std::string& run, const std::string& state);

  KeeperOptions options_;
  Spawner spawner_;
  std::atomic<bool> broken_{false};
  mutable std::recursive_mutex mutex_;  // guards runs_; the observer may ask us
  bool shut_ = false;
  std::map<std::string, Run> runs_;  // by id
};

}  // namespace patina::daemon
