// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/alerts.h"

#include <algorithm>

namespace patina::capture {
namespace {

using namespace std::chrono_literals;

// What has an event of its own in the archive, or might meet a disk without room for one, is no
// fact of this file's.
bool leavesFacts(AlertKind kind) {
  return kind == AlertKind::kCameraDown || kind == AlertKind::kLightHeld ||
         kind == AlertKind::kLightDrifting || kind == AlertKind::kLampDead ||
         kind == AlertKind::kClipping || kind == AlertKind::kSensorBand ||
         kind == AlertKind::kSensorSilent || kind == AlertKind::kSensorDoubtful;
}

}  // namespace

std::string formatLasted(Nanoseconds lasted) {
  std::int64_t rest = std::max<std::int64_t>(lasted / 1s, 0);
  std::string text;
  static constexpr std::pair<int, const char*> kUnits[] = {
      {86'400, "d"}, {3'600, "h"}, {60, "min"}, {1, "s"}};
  for (const auto& [seconds, unit] : kUnits) {
    if (rest < seconds) continue;
    text += std::to_string(rest / seconds) + unit;
    rest %= seconds;
  }
  return text.empty() ? "0s" : text;
}

const char* name(AlertKind kind) {
  static constexpr std::array<const char*, kAlertKindCount> kNames = {
      "no_frames",     "camera_down", "light_held",  "light_drifting", "lamp_dead",
      "light_changed", "clipping",    "sensor_band", "sensor_silent",  "sensor_doubtful",
      "disk_filling",  "disk_full",   "clock_step",  "driver_restart", "scrub_error",
      "archive_io",    "stalled"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* name(Severity severity) {
  return severity == Severity::kCritical  ? "critical"
         : severity == Severity::kWarning ? "warning"
                                          : "info";
}

const char* name(AlertEvent event) {
  return event == AlertEvent::kBegins     ? "begins"
         : event == AlertEvent::kReminder ? "reminder"
                                          : "over";
}

std::string describe(AlertKind kind, const std::string& subject) {
  switch (kind) {
    case AlertKind::kNoFrames:
      return "no frames";
    case AlertKind::kCameraDown:
      return "camera " + subject + " down";
    case AlertKind::kLightHeld:
      return "light " + subject + " held";
    case AlertKind::kLightDrifting:
      return "light " + subject + " drifting";
    case AlertKind::kLampDead:
      return "light " + subject + " dead";
    case AlertKind::kLightChanged:
      return "light " + subject + " changed while its baseline was learned";
    case AlertKind::kClipping:
      return "clipping " + subject;
    case AlertKind::kSensorBand:
      return "surroundings out of band";
    case AlertKind::kSensorSilent:
      return "sensor " + subject + " silent";
    case AlertKind::kSensorDoubtful:
      return "sensor " + subject + " doubtful";
    case AlertKind::kDiskFilling:
      return "disk filling";
    case AlertKind::kDiskFull:
      return "disk full";
    case AlertKind::kClockStep:
      return "clock stepped";
    case AlertKind::kDriverRestart:
      return "driver of " + subject + " restarted";
    case AlertKind::kScrubError:
      return "archive damaged";
    case AlertKind::kArchiveIo:
      return "archive cannot be written";
    case AlertKind::kStalled:
      return "capture stalled";
  }
  return "unknown";
}

// What is judged once a step cannot be over before a second step agreed.
AlertRules defaultAlertRules(Nanoseconds interval) {
  const Nanoseconds two_steps = std::max<Nanoseconds>(2 * interval, 5min);
  const std::vector<Nanoseconds> often = {1h, 24h}, daily = {24h};
  AlertRules rules;
  const auto set = [&](AlertKind kind, AlertRule rule) {
    rules[static_cast<std::size_t>(kind)] = std::move(rule);
  };
  set(AlertKind::kNoFrames,
      {Severity::kCritical, std::max<Nanoseconds>(2 * interval, 1min), 0s, often});
  set(AlertKind::kCameraDown, {Severity::kCritical, 5min, two_steps, often});
  set(AlertKind::kLightHeld, {Severity::kCritical, 5min, two_steps, often});
  set(AlertKind::kLightDrifting, {Severity::kWarning, 30min, two_steps, daily});
  set(AlertKind::kLampDead, {Severity::kCritical, 1min, two_steps, often});
  set(AlertKind::kLightChanged, {Severity::kWarning, 0s, 1h, {}});
  set(AlertKind::kClipping, {Severity::kWarning, 30min, two_steps, daily});
  set(AlertKind::kSensorBand, {Severity::kWarning, 10min, two_steps, daily});
  set(AlertKind::kSensorSilent, {Severity::kWarning, 10min, two_steps, daily});
  set(AlertKind::kSensorDoubtful, {Severity::kWarning, 10min, two_steps, daily});
  set(AlertKind::kDiskFilling, {Severity::kWarning, 10min, 1h, daily});
  set(AlertKind::kDiskFull, {Severity::kCritical, 0s, two_steps, often});
  set(AlertKind::kClockStep, {Severity::kInfo, 0s, 1h, {}});
  set(AlertKind::kDriverRestart, {Severity::kInfo, 0s, 1h, {}});
  set(AlertKind::kScrubError, {Severity::kCritical, 0s, 24h, {}});
  set(AlertKind::kArchiveIo, {Severity::kCritical, 0s, 1h, {}});
  set(AlertKind::kStalled, {Severity::kCritical, two_steps, 0s, often});
  return rules;
}

Alerts::Alerts(AlertRules rules, FactSink facts, NewsSink news)
    : rules_(std::move(rules)), facts_(std::move(facts)), news_(std::move(news)) {}

void Alerts::begin(Watched& watched, const std::string& detail, Moment now) {
  if (watched.times++ == 0) watched.since = now;
  watched.began = now.mono;
  watched.on = true;
  watched.detail = detail;
}

void Alerts::raise(AlertKind kind, const std::string& subject, const std::string& detail,
                   Moment now) {
  if (const auto found = watched_.find({kind, subject}); found != watched_.end())
    found->second.detail = detail;
  look(now);
  Watched& watched = watched_[{kind, subject}];
  const bool begins = !watched.on;
  if (begins) begin(watched, detail, now);
  if (begins && leavesFacts(kind)) facts_(now.utc, describe(kind, subject) + " begins: " + detail);
  settle({kind, subject}, watched, now);
}

void Alerts::clear(AlertKind kind, const std::string& subject, Moment now) {
  const auto found = watched_.find({kind, subject});
  if (found == watched_.end() || !found->second.on) return;
  Watched& watched = found->second;
  watched.on = false;
  watched.ended = now.mono;
  if (leavesFacts(kind))
    facts_(now.utc,
           describe(kind, subject) + " is over after " + formatLasted(now.mono - watched.began));
  look(now);
}

void Alerts::occurred(AlertKind kind, const std::string& subject, const std::string& detail,
                      Moment now) {
  look(now);
  Watched& watched = watched_[{kind, subject}];
  watched.momentary = true;
  begin(watched, detail, now);
  settle({kind, subject}, watched, now);
  watched.on = false;
  watched.ended = now.mono;
}

bool Alerts::raised(AlertKind kind, const std::string& subject) const {
  const auto found = watched_.find({kind, subject});
  return found != watched_.end() && found->second.on;
}

void Alerts::stepDue(MonoTime due, Nanoseconds interval) {
  if (missing_since_) return;
  missing_since_ = due - interval;
  if (last_frame_) missing_since_ = std::max(*missing_since_, *last_frame_);
}

void Alerts::acknowledged(Moment now) {
  last_frame_ = now.mono;
  missing_since_.reset();
  clear(AlertKind::kNoFrames, "", now);
}

// Its onset delay runs from the last frame, not from the moment it is noticed.
void Alerts::watchFrames(Moment now) {
  if (!missing_since_ || now.mono - *missing_since_ < rule(AlertKind::kNoFrames).onset) return;
  Watched& watched = watched_[{AlertKind::kNoFrames, ""}];
  if (watched.on) return;
  const Nanoseconds missing = now.mono - *missing_since_;
  begin(watched, "no frame was acknowledged for " + formatLasted(missing), now);
  watched.since = {now.utc - missing, *missing_since_};
}

// Tells what is to be told of a condition that is on.
void Alerts::settle(const Key& key, Watched& watched, Moment now) {
  if (!watched.on) return;
  const AlertRule& its = rule(key.first);
  if (!watched.told) {
    if (now.mono - watched.since.mono < its.onset) return;
    watched.told = true;
    watched.last_told = now.mono;
    tell(AlertEvent::kBegins, key, watched, now);
    return;
  }
  if (its.reminders.empty() || watched.momentary) return;
  const Nanoseconds wait = its.reminders[std::min(watched.reminded, its.reminders.size() - 1)];
  if (now.mono - watched.last_told < wait) return;
  ++watched.reminded;
  watched.last_told = now.mono;
  tell(AlertEvent::kReminder, key, watched, now);
}

bool Alerts::isOver(const Key& key, const Watched& watched, Moment now) const {
  return !watched.on && now.mono - watched.ended >= rule(key.first).recovery;
}

void Alerts::look(Moment now) {
  watchFrames(now);
  for (auto entry = watched_.begin(); entry != watched_.end();) {
    const auto& [key, watched] = *entry;
    settle(key, entry->second, now);
    if (!isOver(key, watched, now)) {
      ++entry;
      continue;
    }
    // Taken out first: a sink that throws must not tell it again.
    auto over = watched_.extract(entry++);
    const Watched& last = over.mapped();
    if (last.told) tell(AlertEvent::kOver, over.key(), last, now);
  }
}

void Alerts::tell(AlertEvent event, const Key& key, const Watched& watched, Moment now) {
  if (!news_) return;
  AlertNews news;
  news.event = event;
  news.kind = key.first;
  news.subject = key.second;
  news.detail = watched.detail;
  news.severity = rule(key.first).severity;
  news.utc = now.utc;
  news.since_utc = watched.since.utc;
  news.lasted = (event == AlertEvent::kOver ? watched.ended : now.mono) - watched.since.mono;
  news.times = watched.times;
  news.momentary = watched.momentary;
  news_(news);
}

}  // namespace patina::capture
