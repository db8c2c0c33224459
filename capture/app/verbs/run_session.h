// SPDX-License-Identifier: GPL-3.0-or-later
// What `rehearse` and `capture` share: a plan and its rig, the living devices, one session, and the
// steps after it. They differ in the clock.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "capture/app/context.h"
#include "capture/app/daemon/run_files.h"
#include "capture/notify/run_notices.h"
#include "capture/session.h"
#include "capture/workflow/after_run.h"

namespace patina::app {

struct RunOptions {
  std::string plan;
  bool new_run = false;
  bool wait = false;          // `capture`: begin although a camera is not there
  std::string log_acks;       // hidden: file, or number of an open file; a line a frame
  std::string power_cut_log;  // hidden: folder of db/power_cut.h
};
void addRunOptions(Verb& verb, const std::shared_ptr<RunOptions>& options);

using daemon::RunFiles;
// Plan, rig and faults, checked against one another; --seed replaces the plan's.
RunFiles readRunFiles(const Context& context, const std::string& plan);

// The archive as the owner, on the real disk or the one that can forget (`power_cut_log`).
class OwnedArchive {
 public:
  OwnedArchive(const Context& context, const RunOptions& options,
               std::function<void(db::CommitPoint)> at_point = {});
  ~OwnedArchive();
  db::Archive& operator*() { return *archive_; }
  db::Archive* operator->() { return archive_.get(); }

 private:
  std::unique_ptr<db::FileOps> files_;
  std::unique_ptr<db::Archive> archive_;
};

// Runs the session to its end, then the steps after it, and prints the summary. `after_clock` is
// what products are dated by. Without `notices` nobody is told: a rehearsal rouses no one.
void runToEnd(Context& context, const RunOptions& options, const RunFiles& files,
              OwnedArchive& archive, devices::Clock& clock, const capture::RunStart& start,
              capture::notify::RunNotices* notices = nullptr);
// What a plan and its rig say of the steps after; `files` outlives it.
workflow::AfterOptions afterOptions(const RunFiles& files);
// Only the steps after: for a run that ended before them.
void finishAfter(Context& context, const RunFiles& files, const std::string& run_id, Item item);

}  // namespace patina::app
