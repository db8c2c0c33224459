// SPDX-License-Identifier: GPL-3.0-or-later
// The rows of the catalogue as values. Names and units are those of the tables (design, section 3).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "processing/image/sha256.h"
#include "processing/image/units.h"

namespace patina::db {

using RowId = std::int64_t;

struct SpecimenRow {
  RowId id = 0;
  std::string name, process, description, licence;
};
struct RunRow {
  std::string id;  // "20240501T120000Z-banana"
  std::string specimen, plan_toml, plan_sha256, rig_toml, boot_id;
  UtcTime t0_utc;
  MonoTime t0_boot;
  std::uint64_t seed = 1;
  std::string state;                   // "running" "paused" "stopped" "finished" "aborted"
  Nanoseconds interval{}, duration{};  // zero when unknown (import by times)
  std::string rig;                     // its name in the rig file
  std::int64_t number = 0;             // in the order they were added; the archive gives it
};
struct DeviceRow {
  std::string id;    // as the rig calls it: "cam0"
  std::string kind;  // "camera" "light" "sensor" "trigger"
  std::string backend, serial, description;
};

enum class Decision { kPending, kCaptured, kSkipped, kMissed, kFailed, kHeld };
const char* name(Decision d);  // "captured" ...
Decision parseDecision(const std::string& text);

struct StepRow {
  RowId id = 0;
  std::string run_id;
  std::optional<std::int64_t> number;  // nothing: a manual shot
  UtcTime due_utc;
  Decision decision = Decision::kPending;
  std::string reason;  // one line: "late by 412 s" "light key+0.051" "cam0: timeout"
  int retries = 0;
  Nanoseconds held{}, spread{};
  int shots_due = 0, shots_captured = 0;
};

enum class ShotState { kArmed, kCaptured, kFailed, kLost };
const char* name(ShotState s);
ShotState parseShotState(const std::string& text);
struct ShotRow {
  RowId id = 0, step_id = 0;
  std::string device_id, light_state;
  int exposure_index = 0, attempt = 0;
  Nanoseconds exposure{};
  double iso = 0, f_number = 0;
  UtcTime began_utc;
  MonoTime began_mono;
  ShotState state = ShotState::kArmed;
};
struct FrameRow {
  RowId id = 0, shot_id = 0;
  int file_index = 0;
  Sha256 sha256;
  std::string ext;
  std::int64_t bytes = 0;
  SizePx size;
  UtcTime utc;
  MonoTime mono;
  UtcTime acked_utc;
  double saturated_fraction = 0;
  bool missing = false;  // its file is gone: found by recovery, rebuild; never acknowledged so
};
struct ReadingRow {
  RowId id = 0;
  std::string run_id, device_id, quantity, unit;
  std::optional<RowId> step_id;
  double value = 0;
  UtcTime utc;
  std::string quality;  // "ok" "saturated" "silent"
};

// One verdict: one light state, one exposure, one channel of one source, one shot.
struct LightCheckRow {
  RowId id = 0;
  std::string run_id;
  RowId step_id = 0;
  std::optional<RowId> shot_id;
  std::string light_state;
  int exposure_index = 0;
  std::string source;   // "patch:cam0" "sensor:lux0"
  std::string channel;  // "r" "g" "b" "y"; "lx"
  double level = 0;     // linear, of full scale, or in the sensor's unit
  double baseline = 0;  // what it is held against; 0 while learning
  double ratio = 0;     // level / baseline
  double gain = 1;      // multiply the frame's channel by this to undo drift
  std::string
      verdict;  // "learn" "pass" "correct" "hold" "fail" "measure" "saturated" "covered" "at_odds"
  UtcTime utc;
};
struct EventRow {
  RowId id = 0;
  std::string run_id;
  UtcTime utc;
  std::string kind;    // "clock_step" "resumed" "recover" "alarm" "disk" "quarantine" ...
  std::string detail;  // one line or a JSON object
};
struct CalibrationRow {
  RowId id = 0;
  std::string kind;  // "bias" "dark" "flat" "light_gain"
  std::string device_id;
  Nanoseconds exposure{};
  double iso = 0;
  SizePx size;
  double temperature_c = 20;
  std::string light_state;  // of a flat; empty: any
  UtcTime utc;              // when its frames were taken (middle)
  std::string sha256;       // of products/<id>/master.* ; empty for values kept in `value_json`
  std::string value_json;   // what a reader needs: frames used, noise, range
};
struct FrameCalibrationRow {
  RowId frame_id = 0, calibration_id = 0;
  double distance_time_s = 0, distance_temperature_k = 0;
  bool within_tolerance = true;
};
struct ProductRow {
  std::string id;      // "ttf-20240501T120000Z-banana-1"
  std::string kind;    // "ttf" "film" "sheet" "master" "report"
  std::string run_id;  // may be empty
  std::string path;    // below products/<id>/, or absolute when published outside
  std::string command, options_json, version, sha256;
  std::uint64_t seed = 0;
  UtcTime created_utc;
  std::string
      metadata_json;  // TTF database: process, specimen, interval, duration, frames, light...
  std::vector<std::string> input_sha256s;
};

}  // namespace patina::db
