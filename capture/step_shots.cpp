// SPDX-License-Identifier: GPL-3.0-or-later
// The shots of a step: arm, expose, inspect, judge, acknowledge. See step_runner.h.
#include <algorithm>

#include "capture/step_runner.h"

namespace patina::capture {
namespace {

constexpr double kClippingBegins = 0.01, kClippingEnds = 0.005;  // share of a picture's samples
constexpr double kDarkLevel = 0.004, kDarkShare = 0.1;  // of full scale; of the light that was

// No reference patch sees any light: more than a lamp that changed.
bool isDark(const GateVerdict& verdict) {
  bool seen = false;
  for (const db::LightCheckRow& row : verdict.rows) {
    if (!row.source.starts_with("patch:")) continue;
    if (row.level >= std::max(kDarkLevel, kDarkShare * row.baseline)) return false;
    seen = true;
  }
  return seen;
}

}  // namespace

devices::Result<void> StepRunner::light(const Group& group) {
  const auto settled = lamps_.apply(*group.lights, plan_.light_check.settle);
  if (!settled) return tl::make_unexpected(settled.error());
  if (*settled > clock_.mono()) clock_.sleepUntil(*settled, hooks_.abort);
  return {};
}

// Rows before triggers: whatever happens now, it is known that it was tried.
std::vector<StepRunner::Attempt> StepRunner::arm(Group& group) {
  std::vector<Attempt> attempts;
  for (CameraUnit* unit : group.todo) {
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
    const auto ready = unit->prepare(group.exposure);
    a.shot.id = archive_.armShot(a.shot);
    in_flight_.push_back(a.shot);
    attempts.push_back(std::move(a));
    if (!ready) fail(attempts.back(), ready.error());
  }
  if (group.attempt > 0) now_.step->retries += static_cast<int>(attempts.size());
  ++group.attempt;
  return attempts;
}

void StepRunner::expose(std::vector<Attempt>& attempts) {
  for (Attempt& a : attempts) {
    if (a.shot.state != db::ShotState::kArmed) continue;
    devices::ShotRequest request;
    request.sequence = ++sequence_;
    request.key = run_id_ + "/" + std::to_string(a.shot.id);
    auto ticket = a.unit->camera().trigger(request);
    if (!ticket) {
      fail(a, ticket.error());
      continue;
    }
    a.ticket = std::move(*ticket);
    a.shot.began_utc = a.ticket.began_utc;
    a.shot.began_mono = a.ticket.began_mono;
  }
}

void StepRunner::inspect(Attempt& a, const Group& group) {
  if (a.shot.state != db::ShotState::kArmed) return;
  if (hooks_.abort.stop_requested())
    return fail(a, devices::Error{devices::Errc::kTimeout, "aborted by the operator"});
  const MonoTime deadline = a.unit->collectBy(group.exposure, a.ticket.began_mono, now_.slot_end);
  auto frames = a.unit->camera().collect(a.ticket, deadline);
  if (!frames) return fail(a, frames.error());
  a.frames = std::move(*frames);
  a.check = a.unit->frames().check(a.frames, a.ticket, !group.lights->empty());
  for (const std::string& remark : a.check.remarks) event("stale", remark);
  if (a.check.fault == FrameFault::kNone) {
    a.good = true;
    return;
  }
  // Of a camera that is down one broken file is much like the next: they would fill the disk.
  const bool evidence = !a.unit->ladder().down() && (a.check.fault == FrameFault::kDecode ||
                                                     a.check.fault == FrameFault::kLength ||
                                                     a.check.fault == FrameFault::kWrongSize);
  for (const devices::RawFrame& frame : a.frames) {
    if (!evidence || frame.bytes.empty()) continue;
    db::EventRow why;
    why.run_id = run_id_;
    why.utc = clock_.utc();
    why.kind = "quarantine";
    why.detail = a.check.detail;
    archive_.quarantine(frame.bytes, frame.ext, why);
  }
  fail(a, devices::Error{devices::Errc::kCorrupt, a.check.detail});
}

GateVerdict StepRunner::judge(const Group& group, const std::vector<Attempt>& attempts) {
  LightSample sample;
  sample.step_id = now_.step->id;
  sample.light_state = group.state;
  sample.exposure_index = group.exposure_index;
  sample.utc = clock_.utc();
  for (const Attempt& a : attempts)
    if (a.good && a.check.patch)
      sample.patches.push_back({a.unit->id(), *a.check.patch, a.shot.id});
  sample.sensors = sensorSamples(true);
  return gate_.judge(sample);
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
  for (const CheckedFrame& f : a.check.frames) {
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

  a.unit->frames().remember(a.check);
  a.unit->succeeded();
  alerts_.acknowledged(moment());
  alerts_.clear(AlertKind::kCameraDown, a.unit->id(), moment());
  watchClipping(a, group.state);
  for (const CheckedFrame& f : a.check.frames)
    if (!f.frame->card_handle.empty()) static_cast<void>(a.unit->camera().release(*f.frame));
}

void StepRunner::watchClipping(const Attempt& a, const std::string& state) {
  const std::string where = a.unit->id() + " " + state;
  const double percent = a.check.saturated_fraction * 100;
  if (a.check.saturated_fraction > kClippingBegins)
    alerts_.raise(AlertKind::kClipping, where, std::to_string(percent) + " % of the samples",
                  moment());
  else if (a.check.saturated_fraction < kClippingEnds)
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
}

bool StepRunner::shoot(Group& group) {
  if (auto lit = light(group); !lit) {
    now_.device_trouble = lit.error().what;
    alerts_.raise(AlertKind::kLampDead, group.state, lit.error().what, moment());
    group.todo.clear();
    return true;
  }
  auto attempts = arm(group);
  expose(attempts);
  for (Attempt& a : attempts) inspect(a, group);
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
