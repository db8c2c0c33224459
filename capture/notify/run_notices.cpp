// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/run_notices.h"

#include <algorithm>

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;

constexpr Nanoseconds kFarewell = 5s;

bool has(const std::vector<std::string>& list, const std::string& id) {
  return std::find(list.begin(), list.end(), id) != list.end();
}

std::string countsOf(const SessionStatus& s) {
  std::string text =
      std::to_string(s.captured) + " of " + std::to_string(s.steps) + " steps captured";
  const auto unless_none = [&text](const char* what, std::int64_t count) {
    if (count > 0) text += ", " + std::to_string(count) + " " + what;
  };
  unless_none("held", s.held);
  unless_none("skipped", s.skipped);
  unless_none("missed", s.missed);
  unless_none("failed", s.failed);
  return text;
}

Watch watchOf(const AlertSettings& settings, const About& about) {
  const AlertRule& rule = settings.rules[static_cast<std::size_t>(AlertKind::kStalled)];
  return {rule.onset, rule.severity, about};
}

}  // namespace

About aboutOf(const Plan& plan, const devices::RigSpec& rig, const std::string& run_id) {
  return {rig.name, plan.specimen, run_id};
}

Inventory inventoryOf(const devices::RigSpec& rig) {
  Inventory inventory;
  for (const auto& camera : rig.cameras) inventory.cameras.push_back(camera.id);
  for (const auto& light : rig.lights) inventory.lights.push_back(light.id);
  return inventory;
}

RunNotices::RunNotices(Dispatcher& dispatcher, const devices::Clock& clock, const Plan& plan,
                       const devices::RigSpec& rig, const RunStart& start,
                       std::vector<std::unique_ptr<Notifier>> channels)
    : dispatcher_(dispatcher),
      clock_(clock),
      about_(aboutOf(plan, rig, start.run_id)),
      rules_(plan.alerts.rules),
      inventory_(inventoryOf(rig)),
      group_(dispatcher.add(std::move(channels), watchOf(plan.alerts, about_))) {
  showDevices();
  say(start.resumed ? Severity::kWarning : Severity::kInfo,
      start.resumed ? "the run goes on" : "the run begins");
  show({}, "running");
}

RunNotices::~RunNotices() { close(); }

std::vector<ChannelReport> RunNotices::close() {
  auto reports = dispatcher_.remove(group_, kFarewell);
  group_ = 0;
  return reports;
}

Message RunNotices::message(MessageKind kind, Severity severity) const {
  Message m;
  m.kind = kind;
  m.about = about_;
  m.utc = clock_.utc();
  m.severity = severity;
  return m;
}

void RunNotices::say(Severity severity, const std::string& text) {
  Message m = message(MessageKind::kRun, severity);
  m.text = text;
  dispatcher_.post(group_, m);
}

Message RunNotices::messageOf(const AlertNews& news) const {
  Message m = message(MessageKind::kAlert, news.severity);
  m.utc = news.utc;
  m.news = news;
  return m;
}

void RunNotices::tell(const AlertNews& news) {
  dispatcher_.post(group_, messageOf(news));
  if (news.event == AlertEvent::kOver)
    on_.erase({news.kind, news.subject});
  else
    on_.insert({news.kind, news.subject});
  showDevices();
}

// A light is as bad as the worst state it is part of.
void RunNotices::showDevices() {
  for (const std::string& id : inventory_.cameras) state_.cameras[id] = "ok";
  for (const std::string& id : inventory_.lights) state_.lights[id] = "ok";
  static constexpr std::pair<AlertKind, const char*> kWords[] = {
      {AlertKind::kLightDrifting, "drifting"},
      {AlertKind::kLightHeld, "held"},
      {AlertKind::kLampDead, "dead"}};
  for (const auto& [kind, word] : kWords)
    for (const auto& [on, subject] : on_) {
      if (on != kind) continue;
      for (const std::string& light : devices::lightsOfState(subject))
        if (has(inventory_.lights, light)) state_.lights[light] = word;
    }
  for (const auto& [on, subject] : on_)
    if (on == AlertKind::kCameraDown && has(inventory_.cameras, subject))
      state_.cameras[subject] = "down";
}

void RunNotices::show(const SessionStatus& status, const std::string& state) {
  state_.state = state;
  state_.step = status.step;
  state_.steps = status.steps;
  state_.captured = status.captured;
  state_.held = status.held;
  state_.skipped = status.skipped;
  state_.missed = status.missed;
  state_.failed = status.failed;
  state_.disk_free_bytes = status.disk_free_bytes;
  state_.next_due_utc = status.next_due_utc;
  Message m = message(MessageKind::kStatus, Severity::kInfo);
  m.state = state_;
  dispatcher_.post(group_, m);
}

void RunNotices::hookInto(SessionHooks& hooks) {
  hooks.on_status = [this, before = hooks.on_status](const SessionStatus& status) {
    if (before) before(status);
    show(status, "running");
  };
  hooks.on_acknowledged = [this, before = hooks.on_acknowledged](const db::FrameRow& frame) {
    if (before) before(frame);
    dispatcher_.post(group_, message(MessageKind::kFrame, Severity::kInfo));
  };
  hooks.on_alert = [this, before = hooks.on_alert](const AlertNews& news) {
    if (before) before(news);
    tell(news);
  };
  hooks.on_alive = [this, before = hooks.on_alive] {
    if (before) before();
    dispatcher_.alive(group_);
  };
}

void RunNotices::ended(const SessionSummary& summary) {
  const bool disk = summary.end == "disk";
  show(summary.last, summary.end);
  say(disk ? Severity::kCritical : Severity::kInfo,
      disk ? "the run ended with a full disk: " + countsOf(summary.last)
           : "the run " + summary.end + ": " + countsOf(summary.last));
}

void RunNotices::occurred(AlertKind kind, const std::string& subject, const std::string& detail) {
  AlertNews news;
  news.kind = kind;
  news.subject = subject;
  news.detail = detail;
  news.momentary = true;
  news.severity = rules_[static_cast<std::size_t>(kind)].severity;
  news.utc = news.since_utc = clock_.utc();
  dispatcher_.post(group_, messageOf(news));
}

void RunNotices::failed(const Failure& failure) {
  show({}, "failed");
  if (failure.exit() != Exit::kIo)
    return say(Severity::kCritical, std::string("the run ended by an error: ") + failure.what());
  occurred(
      AlertKind::kArchiveIo, "",
      std::string(failure.what()) + "; the session ended, start it again when the disk is well");
}

}  // namespace patina::capture::notify
