// SPDX-License-Identifier: GPL-3.0-or-later
// One run while it is going: what session.h promises. Internal to capture/.
// session.cpp: its loop and its rows; session_wishes.cpp: between steps, where a person is heard.
#pragma once

#include <string>
#include <vector>

#include "capture/scheduler.h"
#include "capture/session.h"
#include "capture/step_runner.h"

namespace patina::capture {

class Session {
 public:
  Session(const Plan& plan, devices::Rig& rig, db::Archive& archive, devices::Clock& clock,
          const RunStart& start, const SessionHooks& hooks);
  SessionSummary run();

 private:
  void takeUp();
  void finishInterrupted(db::StepRow step);
  void takeUpRows();
  void watchClock();
  void watchPause();
  void act(const Decision& d);
  void wait(const Decision& d);
  void shoot(const Decision& d);
  void shootRow(db::StepRow& row, MonoTime slot_end);
  void shootByHand(const Decision& waiting_for);
  void decideWithout(const Decision& d, db::Decision decision, const std::string& reason);
  bool diskHasRoom();
  void forecastDisk();
  void watchDisk();
  Moment moment() const { return {clock_.utc(), clock_.mono()}; }
  void diskIsFull(const std::string& why);
  bool retryRows();
  void record(const db::StepRow& row);
  void tell(const std::string& note);
  void tryEvent(const std::string& kind, const std::string& detail);

  const Plan& plan_;
  db::Archive& archive_;
  devices::Clock& clock_;
  std::string run_id_;
  const SessionHooks& hooks_;
  StepRunner runner_;
  ScheduleState state_;
  SessionStatus status_;
  bool disk_full_ = false;
  UtcTime end_utc_;
  std::vector<db::StepRow> unwritten_;  // rows that the full disk did not take
};

}  // namespace patina::capture
