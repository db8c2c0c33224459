// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/broadcast.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace patina::daemon {
namespace {

double secondsOf(UtcTime utc) { return toSeconds(utc.time_since_epoch()); }

}  // namespace

Broadcast::Broadcast(http::Metrics& metrics, Watchdog& watchdog)
    : metrics_(metrics), watchdog_(watchdog) {
  metrics_.gauge("patina_alerts_active").set(0);
}

void Broadcast::publishTo(Publish publish) {
  const std::lock_guard lock(mutex_);
  publish_ = std::move(publish);
}

void Broadcast::onChange(std::function<void()> call) {
  const std::lock_guard lock(mutex_);
  changed_ = std::move(call);
}

// Under the lock: the server must not go while it is called. It never blocks.
void Broadcast::publish(const std::string& event, const std::string& json) {
  const std::lock_guard lock(mutex_);
  if (publish_) publish_(event, json);
}

std::vector<Alert> Broadcast::alerts() const {
  const std::lock_guard lock(mutex_);
  std::vector<Alert> alerts;
  for (const auto& [key, alert] : alerts_) alerts.push_back(alert);
  return alerts;
}

void Broadcast::committed(Nanoseconds took) {
  metrics_.histogram("patina_commit_seconds").observe(toSeconds(took));
}

void Broadcast::onRun(const RunView& view) {
  metrics_.gauge("patina_interval_seconds", {view.id}).set(toSeconds(view.interval));
  publish("run", jsonOf(view));
  std::function<void()> changed;
  {
    const std::lock_guard lock(mutex_);
    // What a session that is gone had found is found anew by the next.
    if (!view.active)
      std::erase_if(alerts_, [&](const auto& entry) { return entry.second.run_id == view.id; });
    metrics_.gauge("patina_alerts_active").set(static_cast<double>(alerts_.size()));
    changed = changed_;
  }
  if (!view.active) predictFull(view.id, {}, {});
  if (changed) changed();
}

// In order and on one thread a run, unlike the states that people ask for: a loop that has ended
// must never be waited for.
void Broadcast::onSession(const std::string& run_id, Phase phase) {
  if (phase == Phase::kTurns) return watchdog_.turned(run_id);
  phase == Phase::kBegins ? watchdog_.begin(run_id) : watchdog_.end(run_id);
  metrics_.gauge("patina_run_active", {run_id}).set(phase == Phase::kBegins ? 1 : 0);
}

void Broadcast::onStatus(const RunView& view) {
  for (const CameraView& camera : view.cameras)
    metrics_.gauge("patina_camera_up", {camera.status.id}).set(camera.status.up);
  metrics_.gauge("patina_store_free_bytes").set(static_cast<double>(view.status.disk_free_bytes));
  metrics_.gauge("patina_run_active", {view.id}).set(view.status.paused ? 0 : 1);
  bool shot = false;
  {
    const std::lock_guard lock(mutex_);
    shot = just_shot_.erase(view.id) != 0;
  }
  if (shot) metrics_.histogram("patina_slot_late_seconds").observe(toSeconds(view.status.late));
  predictFull(view.id, view.status.disk_full_utc, view.status.now_utc);
  publish("status", jsonOf(view));
}

void Broadcast::onStep(const db::StepRow& step) {
  metrics_.counter("patina_steps_total", {step.run_id, db::name(step.decision)}).add();
  const bool shot = step.number && step.decision != db::Decision::kSkipped &&
                    step.decision != db::Decision::kMissed;
  if (shot) {
    const std::lock_guard lock(mutex_);
    just_shot_.insert(step.run_id);
  }
  publish("step", jsonOf(step));
}

void Broadcast::onShot(const db::ShotRow& shot) {
  metrics_.counter("patina_frames_total", {shot.device_id, db::name(shot.state)}).add();
}

void Broadcast::onFrame(const std::string& run_id, const std::string& camera,
                        const db::FrameRow& frame) {
  if (ack_log_ != nullptr) ack_log_->take(run_id, frame);
  metrics_.gauge("patina_last_ack_timestamp_seconds", {run_id}).set(secondsOf(frame.acked_utc));
  publish("frame", jsonOf(run_id, camera, frame));
}

void Broadcast::onThumbnail(const Sha256& frame, const Bytes& jpeg) {
  if (previews_ != nullptr) previews_->take(frame, jpeg);
}

void Broadcast::onLight(std::span<const db::LightCheckRow> rows) {
  for (const db::LightCheckRow& row : rows) {
    if (row.ratio > 0) metrics_.gauge("patina_light_level_ratio", {row.light_state}).set(row.ratio);
    publish("light", jsonOf(row));
  }
}

void Broadcast::onEvent(const db::EventRow& event) {
  if (event.kind == "clock_step") metrics_.counter("patina_clock_steps_total").add();
  if (event.kind != "recover") return;
  // "cam0: reopen after timeout"; what is said of a lamp at the start has no rung.
  const auto colon = event.detail.find(": "), after = event.detail.find(" after ");
  if (colon == std::string::npos || after == std::string::npos || after < colon) return;
  metrics_
      .counter("patina_camera_resets_total",
               {event.detail.substr(0, colon), event.detail.substr(colon + 2, after - colon - 2)})
      .add();
}

// The session forecasts by what its cameras say their pictures take. Of several runs the one whose
// forecast is worst counts; +Inf: all of them fit.
void Broadcast::predictFull(const std::string& run_id, std::optional<UtcTime> full, UtcTime now) {
  double seconds = std::numeric_limits<double>::infinity();
  {
    const std::lock_guard lock(mutex_);
    if (full)
      until_full_[run_id] = *full - now;
    else
      until_full_.erase(run_id);
    for (const auto& [id, left] : until_full_)
      seconds = std::min(seconds, std::max(0.0, toSeconds(left)));
  }
  metrics_.gauge("patina_store_predicted_full_seconds").set(seconds);
}

void Broadcast::onAlert(const std::string& run_id, const capture::AlertNews& news) {
  put({run_id, capture::describe(news.kind, news.subject), news.detail, news.since_utc},
      news.event == capture::AlertEvent::kOver);
}

void Broadcast::warn(const std::string& what, const std::string& detail, UtcTime utc) {
  put({"", what, detail, utc}, false);
}

void Broadcast::settled(const std::string& what) {
  Alert alert;
  {
    const std::lock_guard lock(mutex_);
    const auto found = alerts_.find(" " + what);
    if (found == alerts_.end()) return;
    alert = found->second;
  }
  put(alert, true);
}

void Broadcast::damaged(const std::string& detail, UtcTime utc) {
  metrics_.counter("patina_scrub_errors_total").add();
  warn(capture::describe(capture::AlertKind::kScrubError, ""), detail, utc);
}

void Broadcast::put(const Alert& alert, bool over) {
  {
    const std::lock_guard lock(mutex_);
    const std::string key = alert.run_id + " " + alert.what;
    if (over)
      alerts_.erase(key);
    else
      alerts_[key] = alert;
    metrics_.gauge("patina_alerts_active").set(static_cast<double>(alerts_.size()));
  }
  publish("alert", jsonOf(alert, over));
}

}  // namespace patina::daemon
