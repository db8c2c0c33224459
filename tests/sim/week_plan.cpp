// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/sim/week_plan.h"

#include <algorithm>
#include <chrono>
#include <cstdio>

#include "processing/image/random.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;

constexpr std::int64_t kNsPerMinute = 60'000'000'000, kMinutesPerDay = 1440;
constexpr std::int64_t kLearning = 14;  // steps
constexpr int kCalmPercent = 65;        // of a week, from where nothing new goes wrong

std::string clockTime(int minutes) {
  char text[8];
  std::snprintf(text, sizeof text, "%02d:%02d", minutes / 60 % 25, minutes % 60);
  return text;
}

class WeekDrawer {
 public:
  explicit WeekDrawer(std::uint64_t seed) : draw_(hashSeed(seed, 0x3eec)) { week_.seed = seed; }

  WeekPlan drawn() {
    const std::vector<Nanoseconds> intervals = {5s, 20s, 1min, 10min, 45min};
    week_.interval = draw_.of(intervals);
    week_.steps = 16 + static_cast<std::int64_t>(draw_.below(25));
    if (draw_.chance(4)) week_.steps *= 6;
    calm_ = week_.steps * kCalmPercent / 100;
    week_.reboots = draw_.chance(50);
    week_.power_cuts = draw_.chance(30);
    drawRig();
    drawPlan();
    drawTroubles();
    drawFaults();
    return week_;
  }

 private:
  Nanoseconds someTime(std::int64_t before_step) {
    const auto ns = static_cast<std::uint64_t>(before_step * week_.interval.count());
    return Nanoseconds{static_cast<std::int64_t>(draw_.below(ns))};
  }
  Nanoseconds intervals(std::uint64_t least, std::uint64_t most) {
    return static_cast<std::int64_t>(least + draw_.below(most - least + 1)) * week_.interval;
  }
  // Of something that begins at `at` and is over before the calm.
  void heal(Nanoseconds end) { week_.healed = std::max(week_.healed, end); }

  void drawRig();
  void drawPlan();
  void drawWindows(std::string& toml);
  void drawSweep(std::string& toml, const std::vector<std::string>& states);
  void drawTroubles();
  void drawFaults();

  Draw draw_;
  WeekPlan week_;
  std::int64_t calm_ = 0;
};

void WeekDrawer::drawRig() {
  std::string& rig = week_.rig_toml;
  rig = "name = \"bench\"\n";
  const std::vector<std::string> formats = {"jpeg", "jpeg", "dng", "raw+jpeg"};
  const std::string format = draw_.of(formats);
  week_.files_a_shot = format == "raw+jpeg" ? 2 : 1;
  for (std::uint64_t i = 0, n = 1 + draw_.below(3); i < n; ++i) {
    week_.cameras.push_back("cam" + std::to_string(i));
    rig += "[[camera]]\nid = \"" + week_.cameras.back() +
           "\"\nbackend = \"twin\"\nsettings = { format = \"" + format + "\" }\n";
  }
  const std::vector<std::string> between = {"on", "off", "keep"};
  week_.lights = {"key", "fill"};
  for (const std::string& light : week_.lights)
    rig += "[[light]]\nid = \"" + light + "\"\nbackend = \"twin\"\nbetween = \"" +
           draw_.of(between) + "\"\n";
  for (const char* quantity : {"illuminance", "temperature", "humidity"})
    if (draw_.chance(35))
      rig += std::string("[[sensor]]\nid = \"") + quantity +
             "0\"\nbackend = \"twin\"\nquantity = \"" + quantity + "\"\n";
  rig += "[twin]\nspecimen = \"grey_card\"\nsize = \"32x32\"\n";
}

void WeekDrawer::drawWindows(std::string& toml) {
  const int offset = static_cast<int>(draw_.below(53)) * 30 - 12 * 60;
  week_.utc_offset_min = offset;
  toml += "utc_offset = \"" + std::string(offset < 0 ? "-" : "+") + clockTime(std::abs(offset)) +
          "\"\n";
  toml += "windows = [";
  for (std::uint64_t i = 0, n = 1 + draw_.below(2); i < n; ++i) {
    WeekPlan::Window w;
    w.from_min = static_cast<int>(draw_.below(kMinutesPerDay));
    w.to_min = static_cast<int>((w.from_min + 240 + draw_.below(900)) % kMinutesPerDay);
    week_.windows.push_back(w);
    toml += "{ from = \"" + clockTime(w.from_min) + "\", to = \"" + clockTime(w.to_min) + "\" }, ";
  }
  toml += "]\n";
}

void WeekDrawer::drawSweep(std::string& toml, const std::vector<std::string>& states) {
  std::vector<std::string> cameras = week_.cameras;
  if (cameras.size() > 1 && draw_.chance(40)) cameras = {cameras[draw_.below(cameras.size())]};
  toml += "[[sweep]]\n";
  if (cameras != week_.cameras) toml += "cameras = [\"" + cameras[0] + "\"]\n";
  toml += "lights = [";
  for (const std::string& state : states)
    toml += state == "off"        ? "[], "
            : state == "fill+key" ? "[\"key\", \"fill\"], "
                                  : "[\"" + state + "\"], ";
  const bool two = draw_.chance(25);
  toml += std::string("]\nexposures = [") + (two ? "\"1/50\", \"1/100\"" : "\"1/50\"") + "]\n";
  for (const std::string& camera : cameras)
    for (const std::string& state : states) {
      week_.owed.push_back({camera, state, 20ms});
      if (two) week_.owed.push_back({camera, state, 10ms});
    }
}

void WeekDrawer::drawPlan() {
  std::string& plan = week_.plan_toml;
  plan = "rig = \"rig.toml\"\nspecimen = \"card\"\nseed = " + std::to_string(week_.seed >> 1) +
         "\ninterval = \"" + formatDuration(week_.interval) + "\"\nduration = \"" +
         formatDuration(week_.steps * week_.interval) + "\"\n";
  // Only a week of hours sees a window close.
  if (week_.interval >= 10min && draw_.chance(60)) drawWindows(plan);
  plan += "\n";
  const std::vector<std::vector<std::string>> choices = {
      {"key"}, {"key", "off"}, {"key", "fill"}, {"fill+key"}, {"key", "fill", "fill+key"}};
  drawSweep(plan, draw_.of(choices));
  if (draw_.chance(20)) drawSweep(plan, {"fill"});
  plan += "[light_check]\n";
  if (draw_.chance(30)) plan += "mode = \"uncontrolled\"\n";
  if (draw_.chance(30)) plan += "band = 0.05\n";
  if (draw_.chance(20)) plan += "settle = \"200ms\"\n";
  if (draw_.chance(30)) plan += "max_hold = \"" + formatDuration(week_.interval / 3) + "\"\n";
  plan += "[late]\npolicy = \"skip\"\n[disk]\nreserve = \"1MB\"\n";
}

void WeekDrawer::drawTroubles() {
  std::vector<Mishap> kinds = {Mishap::kKill, Mishap::kUnplugged, Mishap::kFull, Mishap::kOneError,
                               Mishap::kSuspend};
  if (week_.power_cuts) kinds.push_back(Mishap::kPowerCut);
  // A clock that lies across a reboot is believed, since nothing else is left; and one that lies
  // moves the windows of the day. Not both in one week.
  const bool steps = !week_.reboots && week_.windows.empty();
  if (steps) kinds.push_back(Mishap::kClockStep);
  for (std::uint64_t i = 0, n = draw_.below(6); i < n; ++i) {
    Trouble t;
    t.what = draw_.of(kinds);
    t.at = someTime(calm_ - 5);
    t.seed = draw_.below(1ull << 62);
    t.length =
        t.what == Mishap::kClockStep
            ? Nanoseconds{(static_cast<std::int64_t>(draw_.below(14'400)) - 7'200) * 1'000'000'000}
            : intervals(0, 3) + week_.interval / 7;
    week_.troubles.push_back(t);
    // Whoever is killed needs a while to come back, and adds that.
    heal(t.at + (t.what == Mishap::kClockStep ? Nanoseconds{} : t.length) + week_.interval);
  }
  std::ranges::sort(week_.troubles, {}, &Trouble::at);
}

void WeekDrawer::drawFaults() {
  static const std::vector<std::string> kCamera = {"hang",         "busy",       "lost",
                                                   "partial_file", "duplicate",  "late",
                                                   "stale_frame",  "wrong_size", "corrupt_bytes"};
  static const std::vector<std::string> kLamp = {"lamp_dead", "lamp_step", "lamp_drift",
                                                 "hang",      "lost",      "busy"};
  static const std::vector<std::string> kSensor = {"sensor_silent", "hang", "lost", "busy"};
  for (std::uint64_t i = 0, n = draw_.below(13); i < n; ++i) {
    const auto which = draw_.below(10);
    const bool sensor = which == 9 && week_.rig_toml.find("temperature0") != std::string::npos;
    const bool lamp = !sensor && which >= 6;
    const std::string device =
        sensor ? "temperature0" : draw_.of(lamp ? week_.lights : week_.cameras);
    std::string kind = draw_.of(sensor ? kSensor : lamp ? kLamp : kCamera);
    Nanoseconds at = someTime(calm_ - 5);
    // What is wrong with the light while the gate learns it is what it learns.
    const bool soon = calm_ < kLearning + 8 || !week_.windows.empty();
    if (kind.starts_with("lamp") && soon) kind = "busy";
    if (kind.starts_with("lamp")) at = kLearning * week_.interval + someTime(calm_ - 5 - kLearning);
    // A camera that stays one picture behind cannot be told from a good one by its files alone.
    const bool lasts = kind.starts_with("lamp") || (draw_.chance(40) && kind != "stale_frame");
    const Nanoseconds length = lasts ? intervals(1, 4) : Nanoseconds{};
    week_.faults_toml.append("[[fault]]\nat = \"").append(formatDuration(at));
    week_.faults_toml.append("\"\ndevice = \"").append(device);
    week_.faults_toml.append("\"\nkind = \"").append(kind).append("\"\n");
    if (kind == "lamp_step")
      week_.faults_toml += draw_.chance(50) ? "amount = 0.05\n" : "amount = -0.2\n";
    // What drifted stays so when the drift ends: little enough to be taken in when it is seen
    // again.
    if (kind == "lamp_drift")
      week_.faults_toml +=
          "amount = " + std::to_string(std::max(-1.0, -0.005 * 86'400 / toSeconds(length))) + "\n";
    if (lasts) week_.faults_toml += "duration = \"" + formatDuration(length) + "\"\n";
    heal(at + length + week_.interval);
    if (!lasts && !lamp && !sensor && !week_.windows.empty()) ++week_.waiting;
  }
}

}  // namespace

std::uint64_t Draw::below(std::uint64_t n) { return uniformBelow(hashSeed(seed_, ++drawn_), n); }

bool WeekPlan::isDue(UtcTime t0, std::int64_t slot) const {
  if (windows.empty()) return true;
  const std::int64_t ns = toNs(t0) + slot * interval.count() + utc_offset_min * kNsPerMinute;
  const std::int64_t day_ns = kMinutesPerDay * kNsPerMinute;
  const std::int64_t of_day = ((ns % day_ns) + day_ns) % day_ns;
  for (const Window& w : windows) {
    const std::int64_t from = w.from_min * kNsPerMinute;
    std::int64_t length = (w.to_min - w.from_min) * kNsPerMinute;
    if (length < 0) length += day_ns;
    if ((of_day - from + day_ns) % day_ns < length) return true;
  }
  return false;
}

std::string WeekPlan::describe() const {
  static const char* const kNames[] = {"kill", "power cut",  "unplugged", "full",
                                       "EIO",  "clock step", "suspend"};
  std::string text = rig_toml + plan_toml + faults_toml;
  for (const Trouble& t : troubles)
    text += formatDuration(t.at) + ": " + kNames[static_cast<int>(t.what)] + " " +
            formatDuration(t.length) + "\n";
  return text;
}

WeekPlan drawWeek(std::uint64_t seed) { return WeekDrawer(seed).drawn(); }

}  // namespace patina::testing
