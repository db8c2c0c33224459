// SPDX-License-Identifier: GPL-3.0-or-later
// One step: the whole sweep, with its light verdicts, retries and holds, within its slot.
//
// A light state that is bad does not stop the others: they are shot first, then the bad one is
// tried again until the light is back or the slot ends; seldomer with every step in a row that is
// held, in the end once a step. Between tries the lamps are as between steps.
//
// Cameras are called by their workers: the shutters of one group fire together, pictures are
// collected and checked at the same time. Lamps, sensors, archive and all decisions belong to the
// session's thread, in the order of the rig, so that what is kept is the same for any timing. A
// camera that owes an answer when its slot ends is given up for this step; one that is down is
// tried once a step, and nobody waits for it.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "capture/alerts.h"
#include "capture/camera_unit.h"
#include "capture/event_log.h"
#include "capture/lamps.h"
#include "capture/light_gate.h"
#include "capture/plan.h"
#include "capture/sensor_rounds.h"
#include "capture/session.h"
#include "capture/shutter_lines.h"
#include "db/archive.h"
#include "devices/clock.h"
#include "devices/rig.h"

namespace patina::capture {

struct RecalledPicture;  // recall.h

class StepRunner {
 public:
  StepRunner(const Plan& plan, devices::Rig& rig, db::Archive& archive, devices::Clock& clock,
             const std::string& run_id, const SessionHooks& hooks);

  LightGate& gate() { return gate_; }
  // What an earlier process saw last, oldest first; before the first step.
  void recall(const std::vector<RecalledPicture>& pictures);
  std::map<std::string, RectPx> patches() const;  // by camera
  EventLog& log() { return log_; }
  Alerts& alerts() { return alerts_; }
  const std::string& lightSummary() const { return light_summary_; }
  std::vector<CameraStatus> cameras() const;
  int shotsDue() const { return shots_due_; }
  std::int64_t bytesAStep() const;  // estimate

  void start(std::int64_t next_number);
  void end();        // lamps off
  void keepAwake();  // between steps: drains events, so that no camera falls asleep
  // Between steps, until then or until the session is to stop: sensors are read on their period.
  // DiskFull: not all of their rows could be written; to be called again.
  void sleepUntil(MonoTime due);

  // Shoots the step and fills in its decision. The caller has begun its row, and finishes it when
  // the answer is false: a whole step's row rides in the commit of its last frame.
  // DiskFull: some shots may be taken; settle() later.
  bool run(db::StepRow& step, MonoTime slot_end);
  // After DiskFull: what was in flight becomes failed rows, when there is room again.
  void settle();
  void event(const std::string& kind, const std::string& detail);

 private:
  struct Group {  // one light state and exposure, with the cameras that still owe a picture
    const std::vector<std::string>* lights = nullptr;
    std::string state;
    devices::Exposure exposure;
    int exposure_index = 0;
    std::vector<CameraUnit*> todo;
    int attempt = 0;
    bool held = false;
  };
  struct Attempt {  // one camera's part in one attempt of a group
    CameraUnit* unit = nullptr;
    db::ShotRow shot;
    std::shared_ptr<Answer<devices::Ticket>> ticket;
    std::shared_ptr<Answer<Picture>> picture;
    bool good = false;  // there is a picture, and it passed its check

    const ShotCheck& check() const { return picture->get()->check; }
  };
  struct Progress {  // of the step being shot
    db::StepRow* step = nullptr;
    MonoTime slot_end;
    Nanoseconds groups_to_come{};  // the time that the groups after this one need
    std::optional<MonoTime> held_since, first_shot, last_shot;
    std::string device_trouble, light_trouble;
    bool row_written = false;
  };

  Moment moment() const { return {clock_.utc(), clock_.mono()}; }
  std::vector<Group> groups();
  bool ambientIsFine();
  void tryGroup(Group& group);
  bool shoot(Group& group);  // false: the light was bad
  devices::Result<void> light(const Group& group);
  std::vector<Attempt> arm(Group& group);
  bool alone() const { return units_.size() == 1; }
  bool leftOut(CameraUnit& unit, const Group& group) const;
  MonoTime waitToBeReady(CameraUnit& unit, const Group& group) const;
  void awaitReady(const Group& group);
  void expose(std::vector<Attempt>& attempts, const Group& group);
  void fireLines(std::vector<Attempt>& attempts);
  MonoTime waitForPicture(CameraUnit& unit, const Group& group, MonoTime shutter) const;
  void inspect(Attempt& attempt);
  GateVerdict judge(const Group& group, const std::vector<Attempt>& attempts);
  void accept(Attempt& attempt, Group& group, std::span<const db::LightCheckRow> checks);
  void watchLight(const std::string& state, const GateVerdict& verdict);
  void watchClipping(const Attempt& attempt, const std::string& state);
  void fail(Attempt& attempt, const devices::Error& error);
  void settled(const db::ShotRow& shot);
  void verdicts(std::span<const db::LightCheckRow> rows);
  void reject(std::vector<Attempt>& attempts, const GateVerdict& verdict);
  void dropCamerasThatAreDown(Group& group);
  bool timeFor(const Group& group) const;
  Nanoseconds needs(const Group& group) const;  // to shoot it once
  Nanoseconds needsAfter(const std::vector<Group>& groups, std::size_t index) const;
  MonoTime workEnds() const;  // when nobody is waited for or tried again any more
  bool waitForLight();
  void decide(db::StepRow& step) const;

  const Plan& plan_;
  devices::Rig& rig_;
  db::Archive& archive_;
  devices::Clock& clock_;
  std::string run_id_;
  const SessionHooks& hooks_;
  std::shared_ptr<Doorbell> bell_ = std::make_shared<Doorbell>();
  std::vector<std::unique_ptr<CameraUnit>> units_;
  Lamps lamps_;
  ShutterLines lines_;
  LightGate gate_;
  Alerts alerts_;
  SensorRounds sensors_;
  EventLog log_;
  std::string light_summary_;
  int shots_due_ = 0;
  int held_steps_ = 0;  // in a row: the wait between tries grows with them
  std::vector<db::ShotRow> in_flight_;
  std::uint64_t sequence_ = 0;  // of attempts; rises over restarts too
  bool first_step_ = true;      // cameras are being opened, which takes its time
  Progress now_;
};

}  // namespace patina::capture
