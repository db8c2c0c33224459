// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "capture/forecast.h"
#include "capture/recall.h"
#include "capture/running_session.h"
#include "capture/windows.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

constexpr int kWholeStepsToLearnFrom = 10;  // as many as make a baseline firm
constexpr int kStepsOfPictures = 10;        // and as a content's forecast needs, and two more
constexpr std::size_t kRowsACommit = 10'000;
constexpr const char* kPaused = "paused";  // the reason of what falls due in a pause

Now nowOf(const devices::Clock& clock) { return {clock.utc(), clock.mono(), clock.bootId()}; }

std::string inWords(Nanoseconds left) {
  return left >= 48h ? std::to_string(left / 24h) + " days" : formatLasted(left - left % 1min);
}

}  // namespace

Session::Session(const Plan& plan, devices::Rig& rig, db::Archive& archive, devices::Clock& clock,
                 const RunStart& start, const SessionHooks& hooks)
    : plan_(plan),
      archive_(archive),
      clock_(clock),
      run_id_(start.run_id),
      hooks_(hooks),
      runner_(plan, rig, archive, clock, start.run_id, hooks) {
  status_.run_id = run_id_;
  status_.steps = stepCount(plan, start.t0_utc);
  end_utc_ = start.t0_utc + plan.duration;
}

SessionSummary Session::run() {
  takeUp();
  runner_.start(state_.next_number);
  if (hooks_.paused)
    archive_.changeRunState(run_id_, {"stopped"}, "running");
  else
    archive_.setRunState(run_id_, "running");
  tell("");
  std::string end = "finished";
  while (true) {
    if (hooks_.on_alive) hooks_.on_alive();
    if (hooks_.stop.stop_requested()) {
      end = hooks_.abort.stop_requested() ? "aborted" : "stopped";
      break;
    }
    watchPause();
    watchClock();
    const Decision d = next(plan_, state_, nowOf(clock_));
    if (d.act == Act::kFinish) break;
    act(d);
  }
  runner_.end();
  // Only a disk that does not even take the rows keeps a run from its end.
  if (retryRows()) {
    if (end == "finished" || !hooks_.keep_state) archive_.setRunState(run_id_, end);
  } else if (end == "finished") {
    end = "disk";
  }
  SessionSummary summary;
  tell(end);
  summary.last = status_;
  summary.end = end;
  summary.event_log_sha256 = runner_.log().finish();
  return summary;
}

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
  if (resumption.rebooted) runner_.event("anchor", formatAnchor(state_.anchor));
  status_.paused = hooks_.paused && left->run.state == "paused";
  if (!begun) state_.awake_mono = clock_.mono();
  if (left->unfinished) finishInterrupted(*left->unfinished);
  if (begun) {
    takeUpRows();
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

// Counts, and the light's series: the verdicts of the last steps that were whole hold one row at
// least of every series; what lies before them would only cost time.
void Session::takeUpRows() {
  const auto& reader = archive_.reader();
  const auto steps = reader.steps(run_id_);
  for (const db::StepRow& row : steps) countStep(row, status_);
  std::vector<db::LightCheckRow> checks;
  int whole = 0;
  for (auto row = steps.rbegin(); row != steps.rend() && whole < kWholeStepsToLearnFrom; ++row) {
    if (row->decision == db::Decision::kCaptured) ++whole;
    if (row->shots_captured == 0) continue;
    for (const db::ShotRow& shot : reader.shotsOfStep(row->id))
      for (db::LightCheckRow& check : reader.lightChecksOfShot(shot.id))
        checks.push_back(std::move(check));
  }
  std::sort(checks.begin(), checks.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  runner_.gate().restore(checks);
  // Raw files take seconds to decode: no longer than the next step can wait.
  const MonoTime until = std::max(dueMono(plan_, state_, state_.next_number),
                                  clock_.mono() + std::min<Nanoseconds>(plan_.interval / 4, 10s));
  runner_.recall(recallPictures(reader, run_id_, runner_.patches(), kStepsOfPictures, [&] {
    if (hooks_.on_alive) hooks_.on_alive();
    return !hooks_.stop.stop_requested() && clock_.mono() < until;
  }));
}

void Session::record(const db::StepRow& row) {
  runner_.log().step(row);
  countStep(row, status_);
  if (hooks_.on_step) hooks_.on_step(row);
}

void countStep(const db::StepRow& row, SessionStatus& status) {
  if (!row.number) return;
  ++status.step;
  switch (row.decision) {
    case db::Decision::kCaptured:
      ++status.captured;
      break;
    case db::Decision::kSkipped:
      ++status.skipped;
      break;
    case db::Decision::kMissed:
      ++status.missed;
      break;
    case db::Decision::kFailed:
      ++status.failed;
      break;
    case db::Decision::kHeld:
      ++status.held;
      break;
    case db::Decision::kPending:
      break;
  }
  if (row.shots_captured > 0 && row.shots_captured < row.shots_due) ++status.partial;
}

void Session::tell(const std::string& note) {
  runner_.alerts().look(moment());
  status_.now_utc = clock_.utc();
  status_.next_due_utc = dueUtc(plan_, state_, state_.next_number);
  status_.light = runner_.lightSummary();
  status_.cameras = runner_.cameras();
  status_.note = note;
  if (hooks_.on_status) hooks_.on_status(status_);
}

void Session::watchClock() {
  const Now now = nowOf(clock_);
  if (const auto step = clockStep(state_, now)) {
    acceptClockStep(state_, *step);
    const std::string what =
        "wall time stepped by " + std::to_string(toSeconds(*step)) + " s; steps keep their rhythm";
    tryEvent("clock_step", what);
    runner_.alerts().occurred(AlertKind::kClockStep, "", what, moment());
    tryEvent("anchor", formatAnchor(state_.anchor));
  }
}

void Session::act(const Decision& d) {
  if (status_.paused && (d.act == Act::kShoot || d.act == Act::kSkip)) {
    Decision due = d;
    if (d.act == Act::kShoot) due.count = 1;
    return decideWithout(due, db::Decision::kSkipped, kPaused);
  }
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

bool Session::diskHasRoom() {
  status_.disk_free_bytes = archive_.space().free_bytes;
  forecastDisk();
  return status_.disk_free_bytes >=
         plan_.disk_reserve_bytes + static_cast<std::uint64_t>(runner_.bytesAStep());
}

// By what the cameras say their pictures take.
void Session::forecastDisk() {
  status_.disk_full_utc = diskFullAt(
      {status_.disk_free_bytes, plan_.disk_reserve_bytes, static_cast<double>(runner_.bytesAStep()),
       status_.steps - status_.step, dueUtc(plan_, state_, state_.next_number), end_utc_});
}

void Session::watchDisk() {
  const auto full = status_.disk_full_utc;
  if (full)
    runner_.alerts().raise(AlertKind::kDiskFilling, "",
                           "full in " + inWords(*full - dueUtc(plan_, state_, state_.next_number)) +
                               ", before the run is over: " + formatBytes(status_.disk_free_bytes) +
                               " free",
                           moment());
  else
    runner_.alerts().clear(AlertKind::kDiskFilling, "", moment());
}

void Session::diskIsFull(const std::string& why) {
  runner_.alerts().raise(AlertKind::kDiskFull, "", why, moment());
  if (disk_full_) return;
  disk_full_ = true;
  tryEvent("disk", "no new captures: " + why);
}

// A full disk has no room to be told about; what can be written later is.
void Session::tryEvent(const std::string& kind, const std::string& detail) {
  try {
    runner_.event(kind, detail);
  } catch (const db::DiskFull&) {
    disk_full_ = true;
  }
}

// Rows wait in memory while not even they fit; the session goes on by itself when they do.
bool Session::retryRows() {
  try {
    runner_.settle();
    while (!unwritten_.empty()) {
      if (unwritten_.front().id != 0) {
        archive_.finishStep(unwritten_.front());
        unwritten_.erase(unwritten_.begin());
        continue;
      }
      const auto begun = std::find_if(unwritten_.begin(), unwritten_.end(),
                                      [](const db::StepRow& row) { return row.id != 0; });
      archive_.addSteps(std::span(unwritten_.begin(), begun));
      unwritten_.erase(unwritten_.begin(), begun);
    }
    return true;
  } catch (const db::DiskFull& full) {
    diskIsFull(full.what());
    return false;
  }
}

void Session::decideWithout(const Decision& d, db::Decision decision, const std::string& reason) {
  const MonoTime now = clock_.mono();
  if (decision == db::Decision::kSkipped && reason != kPaused)
    runner_.alerts().stepDue(d.due_mono, plan_.interval);
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
    record(row);
    unwritten_.push_back(std::move(row));
    if (unwritten_.size() >= kRowsACommit) retryRows();
  }
  retryRows();
  state_.awake_mono = now;
  tell(std::string(db::name(decision)) + " " + std::to_string(d.count) + " steps: " + reason);
}

void Session::shootRow(db::StepRow& row, MonoTime slot_end) {
  bool written = false;
  try {
    row.id = archive_.beginStep(row);
    written = runner_.run(row, slot_end);
  } catch (const db::DiskFull& full) {
    row.decision = db::Decision::kSkipped;
    row.reason = "disk";
    diskIsFull(full.what());
  }
  record(row);
  if (written) return;
  unwritten_.push_back(row);
  retryRows();
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
  watchDisk();
  runner_.alerts().clear(AlertKind::kDiskFull, "", moment());
  runner_.alerts().stepDue(d.due_mono, plan_.interval);
  if (disk_full_) {
    disk_full_ = false;
    archive_.renewReserve();
    runner_.event("disk", "room again: captures go on");
  }
  db::StepRow row;
  row.run_id = run_id_;
  row.number = d.number;
  row.due_utc = d.due_utc;
  row.shots_due = runner_.shotsDue();
  status_.late = clock_.mono() - d.due_mono;
  shootRow(row, d.due_mono + plan_.interval);
  state_.next_number = d.number + 1;
  state_.awake_mono = clock_.mono();
  tell(row.reason);
}

SessionSummary runSession(const Plan& plan, devices::Rig& rig, db::Archive& archive,
                          devices::Clock& clock, const RunStart& start, const SessionHooks& hooks) {
  return Session(plan, rig, archive, clock, start, hooks).run();
}

}  // namespace patina::capture
