// SPDX-License-Identifier: GPL-3.0-or-later
// A run as people see it while it is unfinished, and who is told of what happens in it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "capture/session.h"
#include "db/rows.h"

namespace patina::daemon {

struct CameraView {
  capture::CameraStatus status;
  std::int64_t captured = 0, failed = 0;  // shots, since the daemon started
  std::optional<db::FrameRow> newest;
};
struct RunView {
  std::string id, specimen, plan;  // the plan's file
  std::string state;               // of the archive: "running" "paused" "stopped" ...
  std::vector<std::string> devices;
  Nanoseconds interval{};
  std::vector<CameraView> cameras;
  capture::SessionStatus status;
  bool active = false;  // a session is at work
  std::string trouble;  // why none is; it is tried again
};

enum class Phase { kBegins, kTurns, kEnds };  // of a session: kTurns at every turn of its loops

// Told on the threads of the runs, several at a time; must be quick, and throws nothing. What it
// is told of is in the archive already. It may ask the keeper, but not from within onRun.
class RunObserver {
 public:
  virtual ~RunObserver() = default;
  virtual void onRun(const RunView&) {}     // its state, its session or its trouble changed
  virtual void onStatus(const RunView&) {}  // after every step and hold
  virtual void onStep(const db::StepRow&) {}
  virtual void onShot(const db::ShotRow&) {}
  virtual void onFrame(const std::string& /*run_id*/, const std::string& /*camera*/,
                       const db::FrameRow&) {}
  virtual void onThumbnail(const Sha256& /*frame*/, const Bytes& /*jpeg*/) {}
  virtual void onLight(std::span<const db::LightCheckRow>) {}
  virtual void onEvent(const db::EventRow&) {}
  virtual void onAlert(const std::string& /*run_id*/, const capture::AlertNews&) {}
  virtual void onSession(const std::string& /*run_id*/, Phase) {}  // on its thread, in order
};

}  // namespace patina::daemon
