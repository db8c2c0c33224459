// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/session.h"

#include <algorithm>

#include "capture/scheduler.h"
#include "capture/step_runner.h"
#include "capture/windows.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

Now nowOf(const devices::Clock& clock) { return {clock.utc(), clock.mono(), clock.bootId()}; }

bool unfinished(const db::RunRow& run) { return run.state == "running" || run.state == "stopped"; }

std::string freeRunId(const db::ArchiveReader& reader, UtcTime t0, const std::string& specimen) {
  const std::string base = formatUtcCompact(t0) + "-" + specimen;
  const auto runs = reader.runs();
  std::string id = base;
  for (int n = 2; std::any_of(runs.begin(), runs.end(), [&](const auto& r) { return r.id == id; });
       ++n)
    id = base + "-" + std::to_string(n);
  return id;
}

db::EventRow eventRow(const std::string& run_id, UtcTime utc, std::string kind,
                      std::string detail) {
  db::EventRow row;
  row.run_id = run_id;
  row.utc = utc;
  row.kind = std::move(kind);
  row.detail = std::move(detail);
  return row;
}

}  // namespace

RunStart startRun(const Plan& plan, const devices::RigSpec& rig, db::Archive& archive,
                  devices::Clock& clock, const SessionOptions& options) {
  checkAgainst(plan, rig);
  const auto runs = archive.reader().runs();
  for (auto run = runs.rbegin(); run != runs.rend(); ++run) {
    if (!unfinished(*run) || run->specimen != plan.specimen) continue;
    if (options.new_run) {
      archive.addEvent(eventRow(run->id, clock.utc(), "aborted", "a new run was asked for"));
      archive.setRunState(run->id, "aborted");
      continue;
    }
    if (run->plan_sha256 == plan.sha256) return {run->id, run->t0_utc, true};
    throw CaptureError(Exit::kTemporary,
                       "run " + run->id + " is unfinished and was started with another plan than " +
                           plan.source.string() +
                           " is now: a run never changes its plan. Go on with the plan as it was "
                           "(`patina archive show " +
                           run->id + "` prints it), or start a new run with --new-run");
  }
  RunStart start;
  start.t0_utc = options.t0_utc.value_or(
      plan.start_utc && *plan.start_utc > clock.utc() ? *plan.start_utc : clock.utc());
  start.run_id = freeRunId(archive.reader(), start.t0_utc, plan.specimen);
  const ScheduleState schedule = beginSchedule(start.t0_utc, nowOf(clock));
  db::RunRow run;
  run.id = start.run_id;
  run.specimen = plan.specimen;
  run.plan_toml = plan.toml;
  run.plan_sha256 = plan.sha256;
  run.rig_toml = rig.toml;
  run.boot_id = clock.bootId();
  run.t0_utc = start.t0_utc;
  run.t0_boot = schedule.anchor.mono;
  run.seed = plan.seed;
  run.state = "running";
  run.interval = plan.interval;
  run.duration = plan.duration;
  db::SpecimenRow specimen;
  specimen.name = plan.specimen;
  archive.beginRun(run, specimen);
  return start;
}

namespace {

class Session {
 public:
  Session(const Plan& plan, devices::Rig& rig, db::Archive& archive, devices::Clock& clock,
          const RunStart& start, const SessionHooks& hooks)
      : plan_(plan),
        archive_(archive),
        clock_(clock),
        run_id_(start.run_id),
        hooks_(hooks),
        runner_(plan, rig, archive, clock, start.run_id, hooks) {
    status_.run_id = run_id_;
    status_.steps = stepCount(plan, start.t0_utc);
  }

  SessionSummary run() {
    takeUp();
    runner_.start(state_.next_number);
    archive_.setRunState(run_id_, "running");
    std::string end = "finished";
    while (true) {
      if (hooks_.stop.stop_requested()) {
        end = "stopped";
        break;
      }
      watchClock();
      const Decision d = next(plan_, state_, nowOf(clock_));
      if (d.act == Act::kFinish) break;
      act(d);
    }
    runner_.end();
    if (end == "finished" && disk_full_) end = "disk";
    retryRows();
    archive_.setRunState(run_id_, end == "stopped" ? "stopped" : "finished");
    SessionSummary summary;
    tell(end);
    summary.last = status_;
    summary.end = end;
    summary.event_log_sha256 = runner_.log().finish();
    return summary;
  }

 private:
  void takeUp();
  void finishInterrupted(db::StepRow step);
  void countRows();
  void watchClock();
  void act(const Decision& d);
  void wait(const Decision& d);
  void shoot(const Decision& d);
  void shootByHand(const Decision& waiting_for);
  void decideWithout(const Decision& d, db::Decision decision, const std::string& reason);
  bool diskHasRoom();
  void diskIsFull(const std::string& why);
  void writeRow(db::StepRow row);
  bool retryRows();
  void count(const db::StepRow& row);
  void tell(const std::string& note);
  void anchorEvent() {
    archive_.addEvent(eventRow(run_id_, clock_.utc(), "anchor", formatAnchor(state_.anchor)));
  }

  const Plan& plan_;
  db::Archive& archive_;
  devices::Clock& clock_;
  std::string run_id_;
  const SessionHooks& hooks_;
  StepRunner runner_;
  ScheduleState state_;
  SessionStatus status_;
  bool disk_full_ = false;
  std::vector<db::StepRow> unwritten_;  // rows that the full disk did not take
};

void Session::takeUp() {
  const auto left = archive_.runState(run_id_);
  if (!left) throw CaptureError(Exit::kBug, "run " + run_id_ + " is not in the archive");
  std::optional<LastStep> last;
  if (left->last_number)
    if (const auto row = archive_.reader().step(run_id_, *left->last_number))
      last = LastStep{*left->last_number, row->due_utc};
  Anchor anchor{left->run.boot_id, 0, left->run.t0_boot, left->run.t0_utc};
  bool begun = false;
  for (const db::EventRow& e : archive_.reader().events(run_id_)) {
    if (e.kind == "started" || e.kind == "resumed") begun = true;
    if (e.kind != "anchor") continue;
    if (const auto found = parseAnchor(e.detail)) anchor = *found;
  }
  const Resumption resumption = resumeSchedule(anchor, last, nowOf(clock_));
  state_ = resumption.state;
  runner_.event(begun ? "resumed" : "started",
                begun ? "at step " + std::to_string(state_.next_number) +
                            (resumption.note.empty() ? "" : "; " + resumption.note)
                      : "plan " + plan_.sha256);
  if (resumption.rebooted) anchorEvent();
  if (!begun) state_.awake_mono = clock_.mono();
  if (left->unfinished) finishInterrupted(*left->unfinished);
  if (begun) {
    countRows();
    const auto checks = archive_.reader().lightChecks(run_id_);
    runner_.gate().restore(checks);
  }
}

// The process died in this step. What it had acknowledged is kept; the rest was missed.
void Session::finishInterrupted(db::StepRow step) {
  step.shots_captured = 0;
  for (const db::ShotRow& shot : archive_.reader().shotsOfStep(step.id))
    if (shot.state == db::ShotState::kCaptured) ++step.shots_captured;
  const bool whole = step.shots_due > 0 && step.shots_captured == step.shots_due;
  step.decision = whole ? db::Decision::kCaptured : db::Decision::kMissed;
  step.reason = whole ? "" : "interrupted: nobody was running";
  archive_.finishStep(step);
}

void Session::countRows() {
  for (const db::StepRow& row : archive_.reader().steps(run_id_)) count(row);
}

void Session::count(const db::StepRow& row) {
  if (!row.number) return;
  ++status_.step;
  switch (row.decision) {
    case db::Decision::kCaptured:
      ++status_.captured;
      break;
    case db::Decision::kSkipped:
      ++status_.skipped;
      break;
    case db::Decision::kMissed:
      ++status_.missed;
      break;
    case db::Decision::kFailed:
      ++status_.failed;
      break;
    case db::Decision::kHeld:
      ++status_.held;
      break;
    case db::Decision::kPending:
      break;
  }
  if (row.shots_captured > 0 && row.shots_captured < row.shots_due) ++status_.partial;
}

void Session::tell(const std::string& note) {
  status_.now_utc = clock_.utc();
  status_.next_due_utc = dueUtc(plan_, state_, state_.next_number);
  status_.light = runner_.lightSummary();
  status_.note = note;
  if (hooks_.on_status) hooks_.on_status(status_);
}

void Session::watchClock() {
  const Now now = nowOf(clock_);
  if (const auto step = clockStep(state_, now)) {
    acceptClockStep(state_, *step);
    runner_.event("clock_step", "wall time stepped by " + std::to_string(toSeconds(*step)) +
                                    " s; steps keep their rhythm");
    anchorEvent();
  }
}

void Session::act(const Decision& d) {
  switch (d.act) {
    case Act::kWait:
      return wait(d);
    case Act::kShoot:
      return shoot(d);
    case Act::kSkip:
      return decideWithout(d, db::Decision::kSkipped, "late");
    case Act::kMiss:
      return decideWithout(d, db::Decision::kMissed, "nobody was running");
    case Act::kFinish:
      return;
  }
}

void Session::wait(const Decision& d) {
  state_.awake_mono = clock_.mono();
  if (hooks_.shoot_now && hooks_.shoot_now->exchange(false)) return shootByHand(d);
  // In pieces: a manual shot is asked for, cameras fall asleep.
  const Nanoseconds piece = hooks_.shoot_now ? 250ms : 15s;
  if (d.due_mono - clock_.mono() > 15s) runner_.keepAwake();
  clock_.sleepUntil(std::min(d.due_mono, clock_.mono() + piece), hooks_.stop);
}

bool Session::diskHasRoom() {
  status_.disk_free_bytes = archive_.space().free_bytes;
  return status_.disk_free_bytes >=
         plan_.disk_reserve_bytes + static_cast<std::uint64_t>(runner_.bytesAStep());
}

void Session::diskIsFull(const std::string& why) {
  if (disk_full_) return;
  disk_full_ = true;
  try {
    runner_.event("disk", "no new captures: " + why);
  } catch (const db::DiskFull&) {
    // The next one that finds room says it.
  }
}

// Rows wait in memory while not even they fit; the session goes on by itself when they do.
bool Session::retryRows() {
  try {
    runner_.settle();
    while (!unwritten_.empty()) {
      db::StepRow& row = unwritten_.front();
      if (row.id == 0)
        archive_.beginStep(row);
      else
        archive_.finishStep(row);
      unwritten_.erase(unwritten_.begin());
    }
    return true;
  } catch (const db::DiskFull& full) {
    diskIsFull(full.what());
    return false;
  }
}

void Session::writeRow(db::StepRow row) {
  runner_.log().step(row);
  count(row);
  unwritten_.push_back(std::move(row));
  retryRows();
}

void Session::decideWithout(const Decision& d, db::Decision decision, const std::string& reason) {
  const MonoTime now = clock_.mono();
  for (std::int64_t k = d.number; k < d.number + d.count; ++k) {
    state_.next_number = k + 1;
    db::StepRow row;
    row.run_id = run_id_;
    row.number = k;
    row.due_utc = dueUtc(plan_, state_, k);
    if (!insideWindows(plan_, row.due_utc)) continue;
    row.decision = decision;
    row.reason = reason;
    if (decision == db::Decision::kSkipped && reason == "late")
      row.reason +=
          " by " + std::to_string((now - dueMono(plan_, state_, k)).count() / 1'000'000) + " ms";
    row.shots_due = runner_.shotsDue();
    writeRow(std::move(row));
  }
  state_.awake_mono = now;
  tell(std::string(db::name(decision)) + " " + std::to_string(d.count) + " steps: " + reason);
}

void Session::shoot(const Decision& d) {
  Decision one = d;
  one.count = 1;
  if (!retryRows() || !diskHasRoom()) {
    diskIsFull(formatBytes(status_.disk_free_bytes) + " free, reserve " +
               formatBytes(plan_.disk_reserve_bytes));
    decideWithout(one, db::Decision::kSkipped, "disk");
    return;
  }
  if (disk_full_) {
    disk_full_ = false;
    runner_.event("disk", "room again: captures go on");
  }
  db::StepRow row;
  row.run_id = run_id_;
  row.number = d.number;
  row.due_utc = d.due_utc;
  row.shots_due = runner_.shotsDue();
  try {
    row.id = archive_.beginStep(row);
    runner_.run(row, d.due_mono + plan_.interval);
  } catch (const db::DiskFull& full) {
    row.decision = db::Decision::kSkipped;
    row.reason = "disk";
    diskIsFull(full.what());
  }
  state_.next_number = d.number + 1;
  writeRow(row);
  state_.awake_mono = clock_.mono();
  tell(row.reason);
}

void Session::shootByHand(const Decision& waiting_for) {
  db::StepRow row;
  row.run_id = run_id_;
  row.due_utc = clock_.utc();
  row.shots_due = runner_.shotsDue();
  if (!diskHasRoom()) return tell("no manual shot: the disk is full");
  try {
    row.id = archive_.beginStep(row);
    runner_.run(row, std::max(waiting_for.due_mono, clock_.mono() + plan_.interval));
  } catch (const db::DiskFull& full) {
    row.decision = db::Decision::kSkipped;
    row.reason = "disk";
    diskIsFull(full.what());
  }
  writeRow(row);
  tell("manual shot");
}

}  // namespace

SessionSummary runSession(const Plan& plan, devices::Rig& rig, db::Archive& archive,
                          devices::Clock& clock, const RunStart& start, const SessionHooks& hooks) {
  return Session(plan, rig, archive, clock, start, hooks).run();
}

}  // namespace patina::capture
