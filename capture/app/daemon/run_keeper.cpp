// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_keeper.h"

#include <algorithm>
#include <exception>

#include "capture/app/daemon/active_run.h"
#include "capture/notify/run_notices.h"

namespace patina::daemon {
namespace {

using capture::CaptureError;
namespace notify = capture::notify;

bool goesOnByItself(const db::RunRow& row) {
  // An import that was cut short is `patina import`'s to finish.
  return (row.state == "running" || row.state == "paused") && row.boot_id != "import";
}

void refuseWhileStopping(const ActiveRun& run) {
  if (run.stopping())
    throw CaptureError(Exit::kTemporary,
                       "run " + run.id() + " is finishing its frame to stop: try again then");
}

std::string stateOf(const db::Archive& archive, const std::string& run_id) {
  return archive.reader().findRun(run_id).state;
}

}  // namespace

RunKeeper::RunKeeper(KeeperOptions options) : options_(std::move(options)) {}
RunKeeper::~RunKeeper() { shutDown(); }

bool RunKeeper::broken() const { return broken_; }

// Runs whose session has come to its end leave; those in trouble stay, and keep their devices.
void RunKeeper::sweep() {
  std::erase_if(runs_, [&](const auto& entry) {
    const Run& run = entry.second;
    if (run->working()) return false;
    run->join();
    return run->view().trouble.empty();
  });
}

db::RunRow RunKeeper::rowOf(const std::string& run) const {
  return options_.archive.reader().findRun(run);
}

db::RunRow RunKeeper::ownRow(const std::string& run) const {
  db::RunRow row = rowOf(run);
  if (row.boot_id == "import")
    throw CaptureError(Exit::kUsage, "run " + row.id + " was imported: there is nothing to steer");
  return row;
}

RunKeeper::Run RunKeeper::find(const std::string& id) const {
  const auto found = runs_.find(id);
  return found != runs_.end() ? found->second : nullptr;
}

std::filesystem::path RunKeeper::planOf(const std::string& run_id) const {
  std::filesystem::path plan = options_.archive.reader().folder() / "plan.toml";
  for (const db::EventRow& event : options_.archive.reader().events(run_id))
    if (event.kind == "plan") plan = event.detail;
  return plan;
}

RunKeeper::Run RunKeeper::adopt(const db::RunRow& row) {
  auto run = std::make_shared<ActiveRun>(options_.observer, spawner_, row, planOf(row.id));
  runs_[row.id] = run;
  return run;
}

RunView RunKeeper::viewOf(const db::RunRow& row) const {
  if (const Run run = find(row.id)) {
    run->setState(row.state);
    return run->view();
  }
  RunView view;
  view.id = view.status.run_id = row.id;
  view.specimen = row.specimen;
  view.state = row.state;
  return view;
}

void RunKeeper::refuseOverlap(const RunFiles& files, const std::string& own_id) const {
  const auto wanted = claimsOf(files);
  for (const auto& [id, run] : runs_) {
    if (id == own_id) continue;
    for (const std::string& held : run->view().devices)
      if (std::find(wanted.begin(), wanted.end(), held) != wanted.end())
        throw CaptureError(Exit::kTemporary,
                           std::string(held)
                               .append(" is in use by run ")
                               .append(id)
                               .append(": wait for it, or stop it (`patina run stop ")
                               .append(id)
                               .append("`)"));
  }
}

void RunKeeper::launch(const Run& run, const RunFiles& files, const capture::RunStart& start) {
  run->setDevices(claimsOf(files));
  run->begin([this, files, start](ActiveRun& active, const capture::SessionHooks& hooks) {
    session(active, files, start, hooks);
  });
}

void RunKeeper::tryToLaunch(const Run& run) {
  try {
    RunFiles files = runFilesOf(run->row(), run->plan());
    keepOnlyPlanned(files);
    refuseOverlap(files, run->id());
    launch(run, files, {run->id(), run->row().t0_utc, true});
  } catch (const Failure& failure) {
    trouble(*run, failure.what());
    options_.observer.onRun(run->view());
  }
}

void RunKeeper::takeUp() {
  const std::lock_guard lock(mutex_);
  for (const db::RunRow& row : options_.archive.reader().runs())
    if (goesOnByItself(row) && !find(row.id)) tryToLaunch(adopt(row));
}

void RunKeeper::retry() {
  const std::lock_guard lock(mutex_);
  if (shut_ || broken_) return;
  sweep();
  const auto known = runs_;
  for (const auto& [id, run] : known)
    if (!run->working()) tryToLaunch(run);
}

// The whole life of a session, on its own thread.
void RunKeeper::session(ActiveRun& run, const RunFiles& files, const capture::RunStart& start,
                        const capture::SessionHooks& hooks) {
  try {
    shootPlan(run, files, start, hooks);
  } catch (const db::ArchiveError& error) {
    if (error.exit() == Exit::kIo) broken_ = true;
    trouble(run, error.what());
  } catch (const std::exception& error) {
    trouble(run, error.what());
  }
}

void RunKeeper::shootPlan(ActiveRun& run, const RunFiles& files, const capture::RunStart& start,
                          capture::SessionHooks hooks) {
  std::optional<notify::RunNotices> notices;
  if (options_.dispatcher != nullptr) {
    auto channels = notify::openChannels(
        files.plan.alerts, notify::aboutOf(files.plan, files.rig, start.run_id),
        notify::inventoryOf(files.rig), notify::Mqtt::Purpose::kRun);
    for (const std::string& problem : channels.problems)
      note(start.run_id, "alerts", "nothing will be told through " + problem);
    notices.emplace(*options_.dispatcher, options_.clock, files.plan, files.rig, start,
                    std::move(channels.open));
    notices->hookInto(hooks);
  }
  if (options_.stepped && capture::isFedBySteps(files.plan))
    hooks.on_step = [this, id = run.id(), before = hooks.on_step](const db::StepRow& step) {
      if (before) before(step);
      if (step.decision == db::Decision::kCaptured) options_.stepped(id);
    };
  try {
    devices::Rig rig = options_.open_rig(files, start, options_.clock);
    const auto summary =
        capture::runSession(files.plan, rig, options_.archive, options_.clock, start, hooks);
    if (notices) notices->ended(summary);
    run.setState(stateOf(options_.archive, run.id()));
    if (summary.end == "disk")
      trouble(run, "the disk is full: not even the last rows fit; make room");
    if (summary.end == "finished" && options_.finished) options_.finished(run.id());
  } catch (const Failure& failure) {
    if (notices) notices->failed(failure);
    throw;
  }
}

void RunKeeper::note(const std::string& run_id, const std::string& kind,
                     const std::string& detail) {
  db::EventRow event;
  event.run_id = run_id;
  event.utc = options_.clock.utc();
  event.kind = kind;
  event.detail = detail;
  try {
    options_.archive.addEvent(event);
  } catch (const db::ArchiveError&) {
    // The disk is the trouble; it is told to whoever watches.
  }
  options_.observer.onEvent(event);
}

// Said once, however often the run is tried again.
void RunKeeper::trouble(ActiveRun& run, const std::string& what) {
  if (run.setTrouble(what)) note(run.id(), "trouble", what);
}

RunKeeper::Admitted RunKeeper::admit(const std::filesystem::path& plan, bool new_run) {
  if (shut_) throw CaptureError(Exit::kTemporary, "the daemon is shutting down");
  Admitted admitted;
  RunFiles& files = admitted.files = readRunFiles(plan, {});
  sweep();
  for (const auto& [id, run] : runs_) {
    if (run->row().specimen != files.plan.specimen) continue;
    if (new_run)
      throw CaptureError(Exit::kTemporary, "run " + id + " of " + files.plan.specimen +
                                               " is going on: stop or abort it first");
    if (run->row().plan_sha256 != files.plan.sha256) continue;
    refuseWhileStopping(*run);
    if (run->working()) {
      admitted.going = viewOf(rowOf(id));
      return admitted;
    }
  }
  for (const db::RunRow& row : options_.archive.reader().runs())
    if (capture::isUnfinished(row) && row.plan_sha256 == files.plan.sha256 && !new_run)
      admitted.unfinished = row.id;
  admitted.claimed = files;
  keepOnlyPlanned(admitted.claimed);
  refuseOverlap(admitted.claimed, admitted.unfinished);
  return admitted;
}

RunView RunKeeper::start(const std::filesystem::path& plan, const StartOptions& how) {
  std::unique_lock lock(mutex_);
  Admitted admitted = admit(plan, how.new_run);
  if (admitted.going) return *admitted.going;
  if (options_.require_cameras && !how.wait && admitted.unfinished.empty()) {
    // Cameras take their time to open: meanwhile the others go on.
    lock.unlock();
    options_.require_cameras(admitted.claimed.rig, options_.clock);
    lock.lock();
    admitted = admit(plan, how.new_run);
    if (admitted.going) return *admitted.going;
  }
  RunFiles& claimed = admitted.claimed;
  const capture::RunStart begun = capture::startRun(
      admitted.files.plan, admitted.files.rig, options_.archive, options_.clock, {how.new_run, {}});
  options_.archive.changeRunState(begun.run_id, {"stopped"}, "running");
  const db::RunRow row = rowOf(begun.run_id);
  claimed.plan.seed = row.seed;
  const Run run = adopt(row);
  launch(run, claimed, begun);
  return run->view();
}

RunView RunKeeper::pause(const std::string& wanted) {
  const std::lock_guard lock(mutex_);
  const db::RunRow row = ownRow(wanted);
  if (!options_.archive.changeRunState(row.id, {"running", "paused"}, "paused"))
    throw CaptureError(Exit::kUsage, "run " + row.id + " is " + row.state + ": nothing to pause");
  const Run run = find(row.id);
  if (run) run->askToPause(true);
  RunView view = viewOf(rowOf(row.id));
  options_.observer.onRun(view);
  return view;
}

RunView RunKeeper::resume(const std::string& wanted) {
  const std::lock_guard lock(mutex_);
  const db::RunRow row = ownRow(wanted);
  if (!capture::isUnfinished(row))
    throw CaptureError(Exit::kUsage, "run " + row.id + " is " + row.state + ": it does not go on");
  if (shut_) throw CaptureError(Exit::kTemporary, "the daemon is shutting down");
  sweep();
  Run run = find(row.id);
  if (!run) {
    RunFiles files = runFilesOf(row, planOf(row.id));
    keepOnlyPlanned(files);
    refuseOverlap(files, row.id);
    options_.archive.changeRunState(row.id, {"stopped", "paused"}, "running");
    run = adopt(rowOf(row.id));
    launch(run, files, {row.id, row.t0_utc, true});
  } else {
    refuseWhileStopping(*run);
    options_.archive.changeRunState(row.id, {"stopped", "paused"}, "running");
    run->askToPause(false);
    if (!run->working()) tryToLaunch(run);
  }
  RunView view = viewOf(rowOf(row.id));
  options_.observer.onRun(view);
  return view;
}

RunView RunKeeper::endBy(const std::string& wanted, const std::string& state) {
  const std::lock_guard lock(mutex_);
  const db::RunRow row = ownRow(wanted);
  const bool aborts = state == "aborted";
  if (row.state != state &&
      !options_.archive.changeRunState(row.id, {"running", "paused", "stopped"}, state))
    throw CaptureError(Exit::kUsage, "run " + row.id + " is " + row.state + " already");
  const Run run = find(row.id);
  if (run && run->working()) aborts ? run->askToAbort() : run->askToStop();
  if (run && !run->working()) run->setTrouble({});
  RunView view = viewOf(rowOf(row.id));
  options_.observer.onRun(view);
  return view;
}

RunView RunKeeper::stop(const std::string& run) { return endBy(run, "stopped"); }
RunView RunKeeper::abort(const std::string& run) { return endBy(run, "aborted"); }

RunView RunKeeper::shoot(const std::string& wanted) {
  const std::lock_guard lock(mutex_);
  const db::RunRow row = rowOf(wanted);
  const Run run = find(row.id);
  if (!run || !run->working())
    throw CaptureError(Exit::kUsage,
                       "run " + row.id + " is " + row.state + ": nobody is there to shoot");
  run->askForShot();
  return viewOf(row);
}

std::vector<RunView> RunKeeper::runs() const {
  const std::lock_guard lock(mutex_);
  std::vector<RunView> views;
  for (const auto& [id, run] : runs_)
    if (run->working() || !run->view().trouble.empty()) views.push_back(run->view());
  return views;
}

void RunKeeper::shutDown() {
  std::map<std::string, Run> runs;
  {
    const std::lock_guard lock(mutex_);
    shut_ = true;
    runs = runs_;
  }
  // Without the lock: a session's observer may be waiting for it.
  for (const auto& [id, run] : runs) run->askToStop();
  for (const auto& [id, run] : runs) run->join();
  const std::lock_guard lock(mutex_);
  runs_.clear();
}

}  // namespace patina::daemon
