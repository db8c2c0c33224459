// SPDX-License-Identifier: GPL-3.0-or-later
// Conditions that a person should know of, and when to tell: not at every blip, again while it
// lasts, once more when it is over.
//
// Two things come out. Facts, at once: one line when a condition begins, one when it ends, for the
// archive. News, for people: a condition must last for its onset delay before it is told; it is
// over when it has stayed away for its recovery delay, so that one which comes and goes is told
// once and counted; reminders while it lasts. All of it is a function of the reports and their
// moments.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "processing/image/units.h"

namespace patina::capture {

enum class AlertKind {
  kNoFrames,       // nothing acknowledged although steps were due
  kCameraDown,     // the ladder gave up; tried again at every step
  kLightHeld,      // shots are not taken: the light is not that of the run
  kLightDrifting,  // shots are taken, with a remark
  kLampDead,       // does not obey, or gives no light
  kLightChanged,   // while its baseline was learned: earlier shots have other light
  kClipping,
  kSensorBand,  // temperature or humidity out of its band: shots are not taken
  kSensorSilent,
  kSensorDoubtful,  // stuck, or at the end of its range (sensor_watch.h)
  kDiskFilling,     // will be full before the run is over
  kDiskFull,        // no new captures
  kClockStep,
  kDriverRestart,
  kScrubError,  // an archived file is not what it was
  kArchiveIo,   // the session ended
  kStalled      // the session itself has not moved
};
constexpr int kAlertKindCount = 17;
const char* name(AlertKind kind);                                  // "camera_down"
std::string describe(AlertKind kind, const std::string& subject);  // "camera cam0 down"

enum class Severity { kInfo, kWarning, kCritical };
const char* name(Severity severity);

struct AlertRule {
  Severity severity = Severity::kWarning;
  Nanoseconds onset{}, recovery{};
  std::vector<Nanoseconds> reminders;  // the wait before each; the last repeats; empty: none
};
using AlertRules = std::array<AlertRule, kAlertKindCount>;
AlertRules defaultAlertRules(Nanoseconds interval);

enum class AlertEvent { kBegins, kReminder, kOver };
const char* name(AlertEvent event);

struct AlertNews {
  AlertEvent event = AlertEvent::kBegins;
  AlertKind kind = AlertKind::kNoFrames;
  std::string subject;  // camera, light state, sensor; empty where there is only one
  std::string detail;   // of the last report
  Severity severity = Severity::kWarning;
  UtcTime utc, since_utc;
  Nanoseconds lasted{};    // so far, or in all
  int times = 1;           // it came and went so often
  bool momentary = false;  // without a length of its own; that it is over is for machines
};

std::string formatLasted(Nanoseconds lasted);  // "2d1h5min", whole seconds

struct Moment {
  UtcTime utc;    // for people
  MonoTime mono;  // for delays
};

// Single-threaded. The sinks are called from within the reports and may throw through them.
class Alerts {
 public:
  // "camera cam0 down begins: ...", "camera cam0 down is over after 40min"
  using FactSink = std::function<void(UtcTime, const std::string& detail)>;
  using NewsSink = std::function<void(const AlertNews&)>;
  Alerts(AlertRules rules, FactSink facts, NewsSink news);

  void raise(AlertKind kind, const std::string& subject, const std::string& detail, Moment now);
  void clear(AlertKind kind, const std::string& subject, Moment now);
  // Something with no length of its own, as a step of the clock: told, then counted until none has
  // come for the recovery delay.
  void occurred(AlertKind kind, const std::string& subject, const std::string& detail, Moment now);
  bool raised(AlertKind kind, const std::string& subject) const;

  // A step is due. Frames are missed from `interval` before the first due step since the last
  // acknowledgement: hours outside the windows do not count.
  void stepDue(MonoTime due, Nanoseconds interval);
  void acknowledged(Moment now);

  // Time passes: delays run out. Call at every wait and step.
  void look(Moment now);

 private:
  struct Watched {
    bool on = false, told = false, momentary = false;
    Moment since;  // the first time
    MonoTime began, ended, last_told;
    std::size_t reminded = 0;
    int times = 0;
    std::string detail;
  };
  using Key = std::pair<AlertKind, std::string>;
  const AlertRule& rule(AlertKind kind) const { return rules_[static_cast<std::size_t>(kind)]; }
  void begin(Watched& watched, const std::string& detail, Moment now);
  void settle(const Key& key, Watched& watched, Moment now);
  bool isOver(const Key& key, const Watched& watched, Moment now) const;
  void tell(AlertEvent event, const Key& key, const Watched& watched, Moment now);
  void watchFrames(Moment now);

  AlertRules rules_;
  FactSink facts_;
  NewsSink news_;
  std::map<Key, Watched> watched_;
  std::optional<MonoTime> last_frame_, missing_since_;
};

}  // namespace patina::capture
