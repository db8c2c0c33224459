// SPDX-License-Identifier: GPL-3.0-or-later
// One run from its first step to its last: the same code in a week and in its rehearsal.
#pragma once

#include <atomic>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>

#include "capture/alerts.h"
#include "capture/failure.h"
#include "capture/plan.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/rig.h"

namespace patina::capture {

// What a person watching wants to know; after every step and hold.
struct SessionStatus {
  std::string run_id;
  std::int64_t step = 0, steps = 0;
  UtcTime now_utc, next_due_utc;
  std::int64_t captured = 0, skipped = 0, missed = 0, failed = 0, held = 0, partial = 0;
  std::string light;  // "key 0.998 pass"
  std::uint64_t disk_free_bytes = 0;
  std::optional<UtcTime> disk_full_utc;  // when captures will stop; nothing: the run fits
  std::string note;                      // what it is doing or waiting for
};

struct SessionHooks {
  std::function<void(const SessionStatus&)> on_status;
  std::function<void(const db::FrameRow&)> on_acknowledged;  // after the promise
  std::function<void(const AlertNews&)> on_alert;            // what a person should know
  std::function<void()> on_alive;                            // every 15 s at least, but in a shot
  std::atomic<bool>* shoot_now = nullptr;  // SIGUSR1: a manual shot at the next safe point
  std::stop_token stop;                    // SIGTERM: finishes the frame and stops
};

struct SessionSummary {
  SessionStatus last;
  // "finished" "stopped"; "disk": its time is over, but the disk takes not even the last rows.
  std::string end;
  std::string event_log_sha256;  // of every decision, verdict and frame, in order
};

// A new run, or, when `archive` has an unfinished run of the same plan (sha256), that run goes on
// at its next step. A plan that changed while a run is unfinished is refused unless a new run is
// asked for. Throws CaptureError, db::ArchiveError. Single-threaded.
struct SessionOptions {
  bool new_run = false;
  std::optional<UtcTime> t0_utc;
};
struct RunStart {  // decided before devices exist: a twin needs t0
  std::string run_id;
  UtcTime t0_utc;
  bool resumed = false;
};
RunStart startRun(const Plan& plan, const devices::RigSpec& rig, db::Archive& archive,
                  devices::Clock& clock, const SessionOptions& options);
SessionSummary runSession(const Plan& plan, devices::Rig& rig, db::Archive& archive,
                          devices::Clock& clock, const RunStart& start, const SessionHooks& hooks);

}  // namespace patina::capture
