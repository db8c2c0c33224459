// SPDX-License-Identifier: GPL-3.0-or-later
// The shots of a step: arm, expose, inspect, judge, acknowledge. See step_runner.h.
#include <algorithm>

#include "capture/step_runner.h"

namespace patina::capture {
namespace {

constexpr double kClippingBegins = 0.01, kClippingEnds = 0.005;  // share of a picture's samples
constexpr double kDarkLevel = 0.004, kDarkShare = 0.1;  // of full scale; of the light that was

// A call should be back this long after its deadline: the contract of devices/camera.h.
constexpr Nanoseconds kOverdue = std::chrono::seconds(10);

enum class PatchesSee { kNoPatch, kDark, kLight };
PatchesSee whatPatchesSee(const GateVerdict& verdict) {
  PatchesSee seen = PatchesSee::kNoPatch;
  for (const db::LightCheckRow& row : verdict.rows) {
    if (!row.source.starts_with("patch:")) continue;
    if (row.level >= std::max(kDarkLevel, kDarkShare * row.baseline)) return PatchesSee::kLight;
    seen = PatchesSee::kDark;
  }
  return seen;
}

// No reference patch sees any light: more than a lamp that changed.
bool isDark(const GateVerdict& verdict) { return whatPatchesSee(verdict) == PatchesSee::kDark; }

}  // namespace

devices::Result<void> StepRunner::light(const Group& group) {
  const auto settled = lamps_.apply(*group.lights, plan_.light_check.settle);
  if (!settled) return tl::make_unexpected(settled.error());
  if (*settled > clock_.mono())
    sensors_.sleepUntil(*settled, {now_.step->id, nullptr}, hooks_.abort);
  return {};
}

// Whether this attempt goes on without a camera in trouble unless it is ready: it is led up its
// ladder meanwhile, and has an attempt of its own when the others have their pictures.
bool StepRunner::leftOut(CameraUnit& unit, const Group& group) const {
  return unit.ladder().troubled() && !unit.ladder().down() &&
         std::any_of(group.todo.begin(), group.todo.end(),
                     [](CameraUnit* other) { return !other->ladder().troubled(); });
}

// Cameras take their time to open, and one that is alone keeps nobody waiting. Beside others a
// camera that is down gets no time for its rung: a later step finds it done.
MonoTime StepRunner::waitToBeReady(CameraUnit& unit, const Group& group) const {
  const MonoTime now = clock_.mono();
  const MonoTime at_last = now + unit.caps().cycle + kOverdue;
  if (first_step_) return at_last;
  const MonoTime in_slot = std::min(at_last, workEnds() - unit.shotTime(group.exposure));
  if (!unit.ladder().down()) return alone() ? at_last : in_slot;
  if (alone()) return in_slot;
  return unit.answers() ? std::min(in_slot, now + plan_.interval / 20) : now;
}

void StepRunner::awaitReady(const Group& group) {
  for (CameraUnit* unit : group.todo)
    if (!leftOut(*unit, group))
      bell_->wait(clock_, waitToBeReady(*unit, group),
                  [unit] { return unit->prepared().has_value(); });
}

// Rows before triggers: whatever happens now, it is known that it was tried.
std::vector<StepRunner::Attempt> StepRunner::arm(Group& group) {
  for (CameraUnit* unit : group.todo) unit->prepare(group.exposure);
  awaitReady(group);
  std::vector<Attempt> attempts;
  for (CameraUnit* unit : group.todo) {
    const auto ready = unit->prepared();
    if (!ready && leftOut(*unit, group)) {
      now_.device_trouble = unit->id() + ": " + unit->ladder().lastError();
      continue;
    }
    Attempt a;
    a.unit = unit;
    a.shot.step_id = now_.step->id;
    a.shot.device_id = unit->id();
    a.shot.light_state = group.state;
    a.shot.exposure_index = group.exposure_index;
    a.shot.attempt = group.attempt;
    a.shot.exposure = group.exposure.time;
    a.shot.iso = group.exposure.iso.value;
    a.shot.f_number = group.exposure.f_number.value;
    a.shot.began_utc = clock_.utc();
    a.shot.began_mono = clock_.mono();
    a.shot.id = archive_.armShot(a.shot);
    in_flight_.push_back(a.shot);
    attempts.push_back(std::move(a));
    if (!ready)
      fail(attempts.back(), unit->excuse());
    else if (!*ready)
      fail(attempts.back(), ready->error());
  }
  if (group.attempt > 0) now_.step->retries += static_cast<int>(attempts.size());
  ++group.attempt;
  return attempts;
}

// A camera that is alone has all the time it asks for; one beside others is given up when they
// would lose their rhythm, unless pictures take longer than a slot anyway.
MonoTime StepRunner::waitForPicture(CameraUnit& unit, const Group& group, MonoTime shutter) const {
  const Nanoseconds takes = unit.shotTime(group.exposure);
  const MonoTime deadline = unit.collectBy(group.exposure, shutter, now_.slot_end);
  if (alone()) return deadline + kOverdue;
  if (unit.ladder().down()) return std::min(deadline, shutter + takes + unit.caps().cycle);
  if (takes > plan_.interval) return deadline;
  return std::min(deadline + kOverdue, std::max(workEnds(), shutter + takes + plan_.interval / 10));
}

// Once every camera that hangs on a line is armed, or has failed to be: those fire together.
void StepRunner::fireLines(std::vector<Attempt>& attempts) {
  std::vector<std::string> armed;
  for (Attempt& a : attempts) {
    if (a.shot.state != db::ShotState::kArmed || !lines_.serve(a.unit->id())) continue;
    bell_->wait(clock_, clock_.mono() + a.unit->caps().cycle + kOverdue,
                [&a] { return a.ticket->ready(); });
    if (a.ticket->ready() && a.ticket->get()) armed.push_back(a.unit->id());
  }
  if (armed.empty()) return;
  for (const ShutterLines::Fired& fired : lines_.fire(armed)) {
    for (Attempt& a : attempts) {
      if (std::find(fired.cameras.begin(), fired.cameras.end(), a.unit->id()) ==
          fired.cameras.end())
        continue;
      if (!fired.at) {
        // Armed it stays, for a picture that never comes: drained before the next attempt.
        fail(a, {devices::Errc::kTimeout, "its shutter line: " + fired.at.error().what});
        continue;
      }
      a.ticket->get()->began_utc += *fired.at - a.ticket->get()->began_mono;
      a.ticket->get()->began_mono = *fired.at;
    }
  }
}

// Tells all shutters, then asks for all pictures: each worker does both as soon as it can.
void StepRunner::expose(std::vector<Attempt>& attempts, const Group& group) {
  if (hooks_.abort.stop_requested()) return;
  const MonoTime shutter = clock_.mono();
  for (Attempt& a : attempts) {
    if (a.shot.state != db::ShotState::kArmed) continue;
    devices::ShotRequest request;
    request.sequence = ++sequence_;
    request.key = run_id_ + "/" + std::to_string(a.shot.id);
    a.ticket = a.unit->trigger(request);
  }
  fireLines(attempts);
  for (Attempt& a : attempts)
    if (a.shot.state == db::ShotState::kArmed)
      a.picture = a.unit->collect(group.exposure, now_.slot_end, !group.lights->empty());
  for (Attempt& a : attempts)
    if (a.shot.state == db::ShotState::kArmed)
      sensors_.wait(*bell_, waitForPicture(*a.unit, group, shutter), {now_.step->id, nullptr},
                    [&a] { return a.picture->ready(); });
}

void StepRunner::inspect(Attempt& a) {
  if (a.shot.state != db::ShotState::kArmed) return;
  if (hooks_.abort.stop_requested()) {
    if (a.picture && !a.picture->ready()) a.unit->giveUp();
    return fail(a, devices::Error{devices::Errc::kTimeout, "aborted by the operator"});
  }
  if (a.ticket->ready() && a.ticket->get()) {
    a.shot.began_utc = a.ticket->get()->began_utc;
    a.shot.began_mono = a.ticket->get()->began_mono;
  }
  if (!a.picture->ready()) {
    const devices::Error excuse = a.unit->excuse();
    a.unit->giveUp();
    return fail(a, excuse);
  }
  if (!a.picture->get()) return fail(a, a.picture->get().error());
  const ShotCheck& check = a.check();
  for (const std::string& remark : check.remarks) event("stale", remark);
  if (check.fault == FrameFault::kNone) {
    a.good = true;
    return;
  }
  // Of a camera that is down one broken file is much like the next: they would fill the disk.
  const bool evidence = !a.unit->ladder().down() &&
                        (check.fault == FrameFault::kDecode || check.fault == FrameFault::kLength ||
                         check.fault == FrameFault::kWrongSize);
  for (const devices::RawFrame& frame : a.picture->get()->frames) {
    if (!evidence || frame.bytes.empty()) continue;
    db::EventRow why;
    why.run_id = run_id_;
    why.utc = clock_.utc();
    why.kind = "quarantine";
    why.detail = check.detail;
    archive_.quarantine(frame.bytes, frame.ext, why);
  }
  fail(a, devices::Error{devices::Errc::kCorrupt, check.detail});
}

GateVerdict StepRunner::judge(const Group& group, const std::vector<Attempt>& attempts) {
  LightSample sample;
  sample.step_id = now_.step->id;
  sample.light_state = group.state;
  sample.exposure_index = group.exposure_index;
  sample.utc = clock_.utc();
  for (const Attempt& a : attempts) {
    if (!a.good) continue;
    if (a.check().patch) sample.patches.push_back({a.unit->id(), *a.check().patch, a.shot.id});
    if (a.check().tiles) sample.contents.push_back({a.unit->id(), *a.check().tiles, a.shot.id});
  }
  sample.sensors = sensors_.lux();
  GateVerdict verdict = gate_.judge(sample);
  if (const std::string like = verdict.blocks ? gate_.lightLike(verdict.rows) : ""; !like.empty())
    verdict.reason += "; that is the light of " + like + ": is the wrong lamp lit?";
  for (const SensorSample& lux : sample.sensors)
    sensors_.duringShot(lux, group.state, *group.lights,
                        whatPatchesSee(verdict) == PatchesSee::kLight);
  return verdict;
}

void StepRunner::fail(Attempt& a, const devices::Error& error) {
  a.good = false;
  a.shot.state = db::ShotState::kFailed;
  archive_.failShot(a.shot, std::string(devices::name(error.code)) + ": " + error.what);
  settled(a.shot);
  const bool was_down = a.unit->ladder().down();
  a.unit->failed(error);
  now_.device_trouble = a.unit->id() + ": " + a.unit->ladder().lastError();
  if (was_down) return;  // said once; the alarm says when it is over
  if (a.unit->ladder().down())
    alerts_.raise(AlertKind::kCameraDown, a.unit->id(), error.what, moment());
  else
    event("recover", a.unit->id() + ": " + devices::name(a.unit->ladder().rung()) + " after " +
                         a.unit->ladder().lastError());
  if (a.unit->ladder().rung() >= devices::Rung::kReopen && !a.unit->ladder().down())
    alerts_.occurred(AlertKind::kDriverRestart, a.unit->id(), error.what, moment());
}

void StepRunner::reject(std::vector<Attempt>& attempts, const GateVerdict& verdict) {
  if (!now_.held_since) now_.held_since = clock_.mono();
  now_.light_trouble = verdict.reason;
  for (Attempt& a : attempts) {
    if (!a.good) continue;
    a.shot.state = db::ShotState::kFailed;
    archive_.failShot(a.shot, verdict.reason);
    settled(a.shot);
    a.unit->succeeded();  // the camera did its part
  }
  archive_.addLightChecks(verdict.rows);
  verdicts(verdict.rows);
}

void StepRunner::accept(Attempt& a, Group& group, std::span<const db::LightCheckRow> checks) {
  std::vector<db::PendingFrame> pending;
  for (const CheckedFrame& f : a.check().frames) {
    db::PendingFrame p;
    p.file_index = f.frame->file_index;
    p.ext = f.frame->ext;
    p.bytes = f.frame->bytes;
    p.size = f.size;
    p.utc = f.frame->utc;
    p.mono = f.frame->mono;
    p.saturated_fraction = f.saturated_fraction;
    pending.push_back(p);
  }
  const MonoTime mid = pending.front().mono;
  now_.first_shot = now_.first_shot ? std::min(*now_.first_shot, mid) : mid;
  now_.last_shot = now_.last_shot ? std::max(*now_.last_shot, mid) : mid;
  db::StepRow step = *now_.step;
  const bool whole = ++step.shots_captured == step.shots_due;
  if (whole) decide(step);
  a.shot.state = db::ShotState::kCaptured;
  const auto rows =
      archive_.acknowledge(a.shot, pending, checks, clock_.utc(), whole ? &step : nullptr);
  *now_.step = step;
  now_.row_written = whole;
  settled(a.shot);
  std::erase(group.todo, a.unit);
  for (const db::FrameRow& row : rows) {
    log_.frame(a.shot, row);
    if (hooks_.on_acknowledged) hooks_.on_acknowledged(row);
  }
  if (hooks_.on_thumbnail)
    for (const CheckedFrame& f : a.check().frames)
      if (f.frame->seen && !f.frame->seen->thumbnail.empty())
        hooks_.on_thumbnail(f.sha256, f.frame->seen->thumbnail);

  a.unit->succeeded();
  alerts_.acknowledged(moment());
  alerts_.clear(AlertKind::kCameraDown, a.unit->id(), moment());
  watchClipping(a, group.state);
  for (const CheckedFrame& f : a.check().frames)
    if (!f.frame->card_handle.empty()) a.unit->release(*f.frame);
}

void StepRunner::watchClipping(const Attempt& a, const std::string& state) {
  const std::string where = a.unit->id() + " " + state;
  const double percent = a.check().saturated_fraction * 100;
  if (a.check().saturated_fraction > kClippingBegins)
    alerts_.raise(AlertKind::kClipping, where, std::to_string(percent) + " % of the samples",
                  moment());
  else if (a.check().saturated_fraction < kClippingEnds)
    alerts_.clear(AlertKind::kClipping, where, moment());
}

// One cause, one condition: a lamp that gives no light is not told as one that changed.
void StepRunner::watchLight(const std::string& state, const GateVerdict& verdict) {
  std::optional<AlertKind> is;
  if (verdict.blocks)
    is = isDark(verdict) ? AlertKind::kLampDead : AlertKind::kLightHeld;
  else if (!verdict.reason.empty())
    is = AlertKind::kLightDrifting;
  for (const AlertKind kind :
       {AlertKind::kLampDead, AlertKind::kLightHeld, AlertKind::kLightDrifting})
    if (kind != is) alerts_.clear(kind, state, moment());
  if (is) alerts_.raise(*is, state, verdict.reason, moment());
  if (verdict.changed.empty()) return;
  event("light", verdict.changed);
  alerts_.occurred(AlertKind::kLightChanged, state, verdict.changed, moment());
}

bool StepRunner::shoot(Group& group) {
  if (auto lit = light(group); !lit) {
    now_.device_trouble = lit.error().what;
    alerts_.raise(AlertKind::kLampDead, group.state, lit.error().what, moment());
    group.todo.clear();
    return true;
  }
  auto attempts = arm(group);
  expose(attempts, group);
  for (Attempt& a : attempts) inspect(a);
  const auto good =
      std::count_if(attempts.begin(), attempts.end(), [](const Attempt& a) { return a.good; });
  if (good == 0) return true;

  GateVerdict verdict = judge(group, attempts);
  if (!verdict.summary.empty()) light_summary_ = verdict.summary;
  watchLight(group.state, verdict);
  if (verdict.blocks) {
    reject(attempts, verdict);
    return false;
  }
  verdicts(verdict.rows);
  // Rows of a shot go with it; what belongs to none, a sensor's, goes with the first.
  const Attempt* first = nullptr;
  for (Attempt& a : attempts) {
    if (!a.good) continue;
    if (!first) first = &a;
    std::vector<db::LightCheckRow> own;
    for (db::LightCheckRow& row : verdict.rows) {
      if (!row.shot_id && first == &a) row.shot_id = a.shot.id;
      if (row.shot_id == a.shot.id) own.push_back(row);
    }
    accept(a, group, own);
  }
  return true;
}

}  // namespace patina::capture
