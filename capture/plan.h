// SPDX-License-Identifier: GPL-3.0-or-later
// What to shoot, when, under which light: the plan file (design, section 6).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/alert_settings.h"
#include "devices/camera.h"
#include "devices/config_file.h"
#include "devices/rig.h"

namespace patina::capture {

struct Window {  // of the day, in the plan's fixed utc_offset; to < from: over midnight
  Nanoseconds from{}, to{};
};
struct Sweep {
  std::vector<std::string> cameras;              // ids; empty in the file: all of the rig
  std::vector<std::vector<std::string>> lights;  // states: lists of light ids; [] = all off
  std::vector<devices::Exposure> exposures;
};
enum class LightMode { kControlled, kUncontrolled };
struct LightCheck {
  LightMode mode = LightMode::kControlled;
  double band = 0.02;      // relative, both sides, against the forecast
  Nanoseconds settle{};    // after a lamp goes on, before it is measured
  Nanoseconds max_hold{};  // within a step; default, and at most: until the slot ends
};
enum class LatePolicy { kSkip };  // late more than half an interval: skipped, number kept
struct Plan {
  std::filesystem::path rig_file;
  std::string specimen;
  std::uint64_t seed = 1;
  Nanoseconds interval{}, duration{};  // 50 ms to days
  std::optional<UtcTime> start_utc;    // nothing: when the run begins
  Nanoseconds utc_offset{};
  std::vector<Window> windows;  // empty: always
  std::vector<Sweep> sweeps;
  LightCheck light_check;
  LatePolicy late = LatePolicy::kSkip;
  std::uint64_t disk_reserve_bytes = 0;
  std::vector<std::string> after;  // "ttf" "film" "brdf" "stbrdf"
  int after_degree = 3;            // of "stbrdf": polynomials in time
  int after_bin = 1;               // of "brdf": pixels a side of a texel
  // Frames are laid over the first: a motion model's name, or nothing; and what they hold on to.
  std::string after_register;
  std::optional<RectPx> after_fiducial;
  // Besides at every step; nothing: at steps alone.
  std::optional<Nanoseconds> read_sensors_every;
  AlertSettings alerts;
  std::string toml, sha256;  // as read
  std::filesystem::path source;
};

// Throw devices::ConfigError: file, line, key, allowed range.
Plan readPlan(const std::filesystem::path& file);
Plan parsePlan(const std::string& toml, const std::filesystem::path& source);
// Something after the run can be made while it goes on: "brdf", "stbrdf", of frames as they lie.
bool isFedBySteps(const Plan& plan);
// Names in the plan that the rig does not have: a ConfigError on the plan's line.
void checkAgainst(const Plan& plan, const devices::RigSpec& rig);

// Numbers of steps are slots of the grid t0 + k * interval, k in [0, slotCount); a slot that lies
// outside the windows is due to nobody and has no row.
std::int64_t slotCount(const Plan& plan);
std::int64_t stepCount(const Plan& plan, UtcTime t0);  // slots that are due, windows included
std::int64_t stepCount(const Plan& plan);              // from the plan's start, else midnight
std::vector<std::string> camerasOf(const Sweep& sweep, const devices::RigSpec& rig);
int shotsAStep(const Plan& plan, const devices::RigSpec& rig);
int shotsAStep(const Plan& plan);             // a sweep that names no cameras counts as one
Nanoseconds shortestSweep(const Plan& plan);  // exposures and settle times alone

}  // namespace patina::capture
