// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/step_runner.h"

#include <algorithm>

#include "capture/recall.h"

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

constexpr int kStubborn = 6;  // held steps in a row

std::optional<RectPx> patchOf(const devices::RigSpec& spec, const std::string& camera) {
  for (const auto& patch : spec.patches)
    if (patch.camera == camera) return patch.rect_px;
  return std::nullopt;
}

// A step has room for a million attempts, so that a restart goes on above what was used.
std::uint64_t firstSequence(std::int64_t number) {
  return static_cast<std::uint64_t>(number) << 20;
}

}  // namespace

StepRunner::StepRunner(const Plan& plan, devices::Rig& rig, db::Archive& archive,
                       devices::Clock& clock, const std::string& run_id, const SessionHooks& hooks)
    : plan_(plan),
      rig_(rig),
      archive_(archive),
      clock_(clock),
      run_id_(run_id),
      hooks_(hooks),
      lamps_(rig, clock, plan.sweeps.back().lights.back()),
      lines_(rig),
      gate_(plan.light_check, rig.spec.sensors, run_id),
      alerts_(
          plan.alerts.rules, [this](UtcTime, const std::string& detail) { event("alarm", detail); },
          hooks.on_alert),
      sensors_(rig, archive, clock, run_id, plan.read_sensors_every, alerts_) {
  for (auto& camera : rig.cameras)
    units_.push_back(
        std::make_unique<CameraUnit>(camera, patchOf(rig.spec, camera->caps().id), clock, bell_));
  shots_due_ = shotsAStep(plan, rig.spec);
}

std::map<std::string, RectPx> StepRunner::patches() const {
  std::map<std::string, RectPx> patches;
  for (const auto& patch : rig_.spec.patches) patches.emplace(patch.camera, patch.rect_px);
  return patches;
}

void StepRunner::recall(const std::vector<RecalledPicture>& pictures) {
  std::map<std::string, const RecalledPicture*> last;
  for (const RecalledPicture& picture : pictures) {
    last[picture.camera] = &picture;
    gate_.restorePicture(picture);
  }
  for (const auto& unit : units_)
    if (const auto found = last.find(unit->id()); found != last.end())
      unit->recall(found->second->files);
}

std::int64_t StepRunner::bytesAStep() const {
  std::int64_t bytes = 0;
  for (const auto& unit : units_) bytes = std::max(bytes, unit->caps().bytes_a_shot);
  return bytes * shots_due_;
}

void StepRunner::event(const std::string& kind, const std::string& detail) {
  db::EventRow row;
  row.run_id = run_id_;
  row.utc = clock_.utc();
  row.kind = kind;
  row.detail = detail;
  archive_.addEvent(row);
  if (hooks_.on_event) hooks_.on_event(row);
}

std::vector<CameraStatus> StepRunner::cameras() const {
  std::vector<CameraStatus> out;
  for (const auto& unit : units_) {
    const RecoveryLadder& ladder = unit->ladder();
    out.push_back({unit->id(), !ladder.down(), ladder.troubled() ? ladder.lastError() : ""});
  }
  return out;
}

// The shot has its outcome in the archive.
void StepRunner::settled(const db::ShotRow& shot) {
  std::erase_if(in_flight_, [&](const db::ShotRow& s) { return s.id == shot.id; });
  if (hooks_.on_shot) hooks_.on_shot(shot);
}

void StepRunner::verdicts(std::span<const db::LightCheckRow> rows) {
  log_.checks(rows);
  if (hooks_.on_light && !rows.empty()) hooks_.on_light(rows);
}

void StepRunner::start(std::int64_t next_number) {
  sequence_ = firstSequence(next_number);
  for (const devices::Error& error : lamps_.start()) event("recover", error.what);
  for (const devices::Error& error : lines_.start()) event("recover", error.what);
  if (next_number > 0) lamps_.rest();  // a run that goes on: kept lamps as they were
  for (const devices::Error& error : sensors_.start()) event("recover", error.what);
}

void StepRunner::end() { lamps_.allOff(); }

void StepRunner::keepAwake() {
  for (const auto& unit : units_) {
    for (const std::string& said : unit->takeEvents()) event("camera", unit->id() + ": " + said);
    if (!unit->ladder().troubled()) unit->poll();
  }
}

void StepRunner::sleepUntil(MonoTime due) {
  const auto lit = lamps_.lit();
  sensors_.sleepUntil(due, {{}, &lit}, hooks_.stop);
}

// The end of a slot is for rows and files, which take time on a real clock alone.
MonoTime StepRunner::workEnds() const {
  if (!clock_.threadSafe()) return now_.slot_end;
  return now_.slot_end - std::min<Nanoseconds>(plan_.interval / 4, 1s) - now_.groups_to_come;
}

std::vector<StepRunner::Group> StepRunner::groups() {
  std::vector<Group> out;
  int first_index = 0;  // two sweeps never share an exposure index
  for (const Sweep& sweep : plan_.sweeps) {
    const auto cameras = camerasOf(sweep, rig_.spec);
    for (const auto& lights : sweep.lights)
      for (std::size_t e = 0; e < sweep.exposures.size(); ++e) {
        Group g;
        g.lights = &lights;
        g.state = devices::lightStateName(lights);
        g.exposure = sweep.exposures[e];
        g.exposure_index = first_index + static_cast<int>(e);
        for (const auto& unit : units_)
          if (std::find(cameras.begin(), cameras.end(), unit->id()) != cameras.end())
            g.todo.push_back(unit.get());
        out.push_back(std::move(g));
      }
    first_index += static_cast<int>(sweep.exposures.size());
  }
  return out;
}

// Temperature, humidity: before a shutter is worn on a shot that would not be taken.
bool StepRunner::ambientIsFine() {
  LightSample sample;
  sample.step_id = now_.step->id;
  sample.light_state = "off";
  sample.sensors = sensors_.ambient();
  sample.utc = clock_.utc();
  if (sample.sensors.empty()) return true;
  const GateVerdict verdict = gate_.judge(sample);
  if (!verdict.rows.empty()) archive_.addLightChecks(verdict.rows);
  verdicts(verdict.rows);
  if (!verdict.blocks) {
    alerts_.clear(AlertKind::kSensorBand, "", moment());
    return true;
  }
  now_.light_trouble = verdict.reason;
  alerts_.raise(AlertKind::kSensorBand, "", verdict.reason, moment());
  return false;
}

Nanoseconds StepRunner::needs(const Group& group) const {
  Nanoseconds needed{0};
  for (const CameraUnit* unit : group.todo)
    needed = std::max(needed, unit->shotTime(group.exposure));
  return needed;
}

Nanoseconds StepRunner::needsAfter(const std::vector<Group>& groups, std::size_t index) const {
  Nanoseconds needed{0};
  for (std::size_t i = index + 1; i < groups.size(); ++i) {
    needed += needs(groups[i]);
    if (groups[i].state != groups[i - 1].state) needed += plan_.light_check.settle;
  }
  return needed;
}

bool StepRunner::timeFor(const Group& group) const {
  return clock_.mono() + needs(group) <= workEnds();
}

void StepRunner::dropCamerasThatAreDown(Group& group) {
  std::erase_if(group.todo, [&](CameraUnit* unit) {
    if (!unit->ladder().down()) return false;
    now_.device_trouble = unit->id() + ": " + unit->ladder().lastError();
    return true;
  });
}

// Until every camera has its picture, the light turns out bad, or the cameras or the slot give out.
void StepRunner::tryGroup(Group& group) {
  group.held = false;
  while (!group.todo.empty()) {
    if (hooks_.on_alive) hooks_.on_alive();
    if (!shoot(group)) {
      group.held = true;
      return;
    }
    dropCamerasThatAreDown(group);
    if (group.todo.empty() || hooks_.stop.stop_requested()) return;
    if (!timeFor(group)) {
      group.todo.clear();  // what is missing has its reason in device_trouble
      return;
    }
  }
}

bool StepRunner::waitForLight() {
  if (!now_.held_since) now_.held_since = clock_.mono();
  const MonoTime until = std::min(now_.slot_end, *now_.held_since + plan_.light_check.max_hold);
  // The longer the light has been away, the fewer shutters are worn on asking.
  const int patience = std::min(held_steps_, 3);
  Nanoseconds poll = std::clamp<Nanoseconds>(plan_.interval / 20, 50ms, 30s) * (1 << patience);
  // Every try warms the lamps. At last a step is tried once, when it is due (a long one once an
  // hour): then they have the rhythm that the baseline was learned under, and no hold lasts because
  // of what we do to end it.
  if (held_steps_ >= kStubborn) poll = std::max(poll, std::min<Nanoseconds>(plan_.interval, 1h));
  const MonoTime due = clock_.mono() + poll;
  if (due >= until) return false;
  lamps_.rest();
  const auto lit = lamps_.lit();
  return sensors_.sleepUntil(due, {now_.step->id, &lit}, hooks_.stop) == devices::Wake::kDue;
}

bool StepRunner::run(db::StepRow& step, MonoTime slot_end) {
  now_ = Progress{};
  now_.step = &step;
  now_.slot_end = slot_end;
  if (step.number) sequence_ = std::max(sequence_, firstSequence(*step.number + 1));
  for (const auto& unit : units_) unit->newStep();
  const auto lit = lamps_.lit();
  sensors_.round({step.id, &lit});
  auto pending = groups();
  bool fine = ambientIsFine();
  while (!hooks_.stop.stop_requested()) {
    if (fine) {
      for (std::size_t i = 0; i < pending.size() && !hooks_.stop.stop_requested(); ++i) {
        Group& group = pending[i];
        now_.groups_to_come = needsAfter(pending, i);
        if (!group.held || timeFor(group)) tryGroup(group);
      }
      std::erase_if(pending, [](const Group& g) { return g.todo.empty(); });
      if (pending.empty()) break;
    }
    if (!waitForLight()) break;
    fine = ambientIsFine();
  }
  lamps_.rest();
  first_step_ = false;
  if (!now_.row_written) decide(step);
  held_steps_ = step.decision == db::Decision::kHeld ? held_steps_ + 1 : 0;
  return now_.row_written;
}

void StepRunner::decide(db::StepRow& step) const {
  if (now_.held_since) step.held = clock_.mono() - *now_.held_since;
  if (now_.first_shot) step.spread = *now_.last_shot - *now_.first_shot;
  if (step.shots_captured == step.shots_due) {
    step.decision = db::Decision::kCaptured;
    if (now_.held_since) step.reason = now_.light_trouble;
  } else if (hooks_.stop.stop_requested()) {
    step.decision = db::Decision::kMissed;
    step.reason =
        std::string(hooks_.abort.stop_requested() ? "aborted" : "stopped") + " by the operator";
  } else if (!now_.device_trouble.empty()) {
    step.decision = db::Decision::kFailed;
    step.reason = now_.device_trouble;
  } else {
    step.decision = db::Decision::kHeld;
    step.reason = now_.light_trouble;
  }
}

void StepRunner::settle() {
  while (!in_flight_.empty()) {
    db::ShotRow shot = in_flight_.back();
    shot.state = db::ShotState::kFailed;
    archive_.failShot(shot, "disk full");
    in_flight_.pop_back();
  }
}

}  // namespace patina::capture
