// SPDX-License-Identifier: GPL-3.0-or-later
// One run from its first step to its last: the same code in a week and in its rehearsal.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "capture/alerts.h"
#include "capture/failure.h"
#include "capture/plan.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/rig.h"

namespace patina::capture {

struct CameraStatus {
  std::string id;
  bool up = true;       // false: its ladder is at its end; it is tried once a step
  std::string trouble;  // its last error; empty: none
};

// What a person watching wants to know; after every step and hold.
struct SessionStatus {
  std::string run_id;
  std::int64_t step = 0, steps = 0;
  UtcTime now_utc, next_due_utc;
  std::int64_t captured = 0, skipped = 0, missed = 0, failed = 0, held = 0, partial = 0;
  std::string light;  // "key 0.998 pass", "key learning 2 of 3"
  std::uint64_t disk_free_bytes = 0;
  std::optional<UtcTime> disk_full_utc;  // when captures will stop; nothing: the run fits
  std::string note;                      // what it is doing or waiting for
  bool paused = false;
  Nanoseconds late{};  // of the last step that was shot: from due to begun
  std::vector<CameraStatus> cameras;
};

void countStep(const db::StepRow& row, SessionStatus& status);  // a step that is decided

// Calls come on the session's thread.
struct SessionHooks {
  std::function<void(const SessionStatus&)> on_status;
  std::function<void(const db::FrameRow&)> on_acknowledged;  // after the promise
  // After it, where the driver's process made a small JPEG of the frame: so far a stranger's bytes.
  std::function<void(const Sha256&, const Bytes& thumbnail)> on_thumbnail;
  std::function<void(const AlertNews&)> on_alert;   // what a person should know
  std::function<void(const db::ShotRow&)> on_shot;  // settled: captured or failed
  std::function<void(const db::StepRow&)> on_step;  // decided
  std::function<void(std::span<const db::LightCheckRow>)> on_light;
  std::function<void(const db::EventRow&)> on_event;  // written
  std::function<void()> on_alive;  // at every turn of its loops: at least once a shot, or 15 s
  std::atomic<bool>* shoot_now = nullptr;  // SIGUSR1: a manual shot at the next safe point
  // Between steps: those that fall due meanwhile are skipped, reason "paused"; a manual shot is
  // taken all the same. Read often, written by anybody.
  const std::atomic<bool>* paused = nullptr;
  std::stop_token stop;   // SIGTERM: finishes the frame and stops
  std::stop_token abort;  // with stop: waits for no light and no picture; the run is "aborted"
  // Who stops the session has written the run's state, or wants it to go on: it stays as it is.
  bool keep_state = false;
};

struct SessionSummary {
  SessionStatus last;
  // "finished" "stopped" "aborted"; "disk": its time is over, but the disk takes not even the last
  // rows.
  std::string end;
  std::string event_log_sha256;  // of every decision, verdict and frame, in order
};

// A new run, or, when `archive` has an unfinished run of the same plan (sha256), that run goes on
// at its next step. A plan that changed while a run is unfinished is refused unless a new run is
// asked for. Throws CaptureError, db::ArchiveError. One thread calls; hooks, lamps, sensors and
// archive are called from it, cameras from a worker each, unless the clock is of one thread. A
// camera whose call has not returned when the session ends is taken out of `rig`, which then holds
// nothing in its place: see callsStillOut() in camera_worker.h.
struct SessionOptions {
  bool new_run = false;
  std::optional<UtcTime> t0_utc;
  // Called when a new run is about to begin, not when one goes on: throws what keeps it from it,
  // and nothing has changed.
  std::function<void()> before_new = {};
};
struct RunStart {  // decided before devices exist: a twin needs t0
  std::string run_id;
  UtcTime t0_utc;
  bool resumed = false;
};
bool isUnfinished(const db::RunRow& run);  // it can go on
RunStart startRun(const Plan& plan, const devices::RigSpec& rig, db::Archive& archive,
                  devices::Clock& clock, const SessionOptions& options);
SessionSummary runSession(const Plan& plan, devices::Rig& rig, db::Archive& archive,
                          devices::Clock& clock, const RunStart& start, const SessionHooks& hooks);

}  // namespace patina::capture
