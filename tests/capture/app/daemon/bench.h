// SPDX-License-Identifier: GPL-3.0-or-later
// A keeper on a small twin in virtual time, and an observer that a test can steer and wait by.
#pragma once

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

#include "capture/app/daemon/run_keeper.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/twin/twin.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {

class Watcher : public RunObserver {
 public:
  void onRun(const RunView& view) override {
    const std::lock_guard lock(mutex_);
    if (!view.active && view.state != "") ended_.insert(view.id);
    views_.push_back(view);
    changed_.notify_all();
  }
  void onFrame(const std::string& run_id, const std::string& camera, const db::FrameRow&) override {
    int count = 0;
    {
      const std::lock_guard lock(mutex_);
      count = ++frames_;
      frames_of_.push_back(camera);
      changed_.notify_all();
    }
    if (on_frame) on_frame(run_id, count);
  }
  void onStep(const db::StepRow& step) override {
    if (on_step) on_step(step);
  }
  void onEvent(const db::EventRow& event) override {
    const std::lock_guard lock(mutex_);
    events_.push_back(event.kind + " " + event.detail);
  }
  void onAlert(const std::string&, const capture::AlertNews& news) override {
    const std::lock_guard lock(mutex_);
    alerts_.push_back(std::string(capture::name(news.event)) + " " + capture::name(news.kind));
  }

  // Until no session of the run is at work; call begin() before what starts it.
  void begin(const std::string& run_id) {
    const std::lock_guard lock(mutex_);
    ended_.erase(run_id);
  }
  void waitForEnd(const std::string& run_id) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return ended_.contains(run_id); });
  }
  std::vector<std::string> events() const {
    const std::lock_guard lock(mutex_);
    return events_;
  }
  std::vector<std::string> alerts() const { return alerts_; }  // of runs that have ended
  std::vector<RunView> views() const {
    const std::lock_guard lock(mutex_);
    return views_;
  }

  std::function<void(const std::string& run_id, int count)> on_frame;  // count: of all runs
  std::function<void(const db::StepRow&)> on_step;

 private:
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::set<std::string> ended_;
  std::vector<RunView> views_;
  std::vector<std::string> events_, alerts_, frames_of_;
  int frames_ = 0;
};

// Twelve steps in two hours, one shot each; `cameras` and `lights` make two plans overlap or not.
inline void writePlan(const testing::TempFolder& folder, const std::string& name,
                      const std::string& camera = "cam0", const std::string& light = "key",
                      const std::string& more = {}) {
  testing::writeFile(folder / (name + ".toml"), "rig = \"rig.toml\"\nspecimen = \"" + name +
                                                    "\"\ninterval = \"10min\"\nduration = "
                                                    "\"2h\"\n[[sweep]]\ncameras = [\"" +
                                                    camera + "\"]\nlights = [[\"" + light +
                                                    "\"]]\nexposures = [\"1/50\"]\n" + more);
}

class Bench {
 public:
  Bench() {
    std::string rig = "name = \"bench\"\n";
    for (const char* id : {"cam0", "cam1"})
      rig += std::string("[[camera]]\nid = \"") + id +
             "\"\nbackend = \"twin\"\nsettings = { format = \"jpeg\" }\n";
    for (const char* id : {"key", "fill"})
      rig += std::string("[[light]]\nid = \"") + id + "\"\nbackend = \"twin\"\n";
    rig += "[twin]\nspecimen = \"grey_card\"\nsize = \"64x48\"\n";
    testing::writeFile(folder / "rig.toml", rig);
    writePlan(folder, "card");
    open();
  }

  // The daemon's process dies and another one begins; what is not in the archive is forgotten.
  void open() {
    keeper.reset();
    archive.reset();
    db::ArchiveOptions options;
    options.folder = folder / "archive";
    options.owner = "bench";
    archive = std::make_unique<db::Archive>(options);
    keeper = std::make_unique<RunKeeper>(KeeperOptions{
        *archive, clock, watcher,
        [this](const RunFiles& files, const capture::RunStart& start, devices::Clock& time) {
          if (!no_rig.empty()) throw capture::CaptureError(Exit::kUnavailable, no_rig);
          return openRig(files, start, time);
        },
        [this](const devices::RigSpec&, devices::Clock&) {
          ++asked_for_cameras;
          if (!no_camera.empty()) throw capture::CaptureError(Exit::kUnavailable, no_camera);
        },
        dispatcher, [this](const std::string& run_id) { stepped.push_back(run_id); },
        [this](const std::string& run_id) { finished.push_back(run_id); }});
  }

  RunView start(const std::string& plan = "card", bool new_run = false) {
    return keeper->start(folder / (plan + ".toml"), {new_run, false});
  }
  std::string stateOf(const std::string& run_id) { return archive->reader().findRun(run_id).state; }
  std::vector<std::string> decisions(const std::string& run_id) {
    std::vector<std::string> out;
    for (const db::StepRow& step : archive->reader().steps(run_id))
      out.push_back((step.number ? "" : "by hand ") + std::string(db::name(step.decision)) +
                    (step.reason.empty() ? "" : ": " + step.reason));
    return out;
  }

  testing::TempFolder folder = testing::TempFolder::inMemory();
  devices::VirtualClock clock{parseUtc("2024-05-01T12:00:00Z")};
  Watcher watcher;
  std::string no_camera;  // what is said of a new run's cameras
  int asked_for_cameras = 0;
  std::string no_rig;                                 // why the devices cannot be opened
  capture::notify::Dispatcher* dispatcher = nullptr;  // from the next open() on
  std::vector<std::string> stepped, finished;
  std::unique_ptr<db::Archive> archive;
  std::unique_ptr<RunKeeper> keeper;
};

}  // namespace patina::daemon
