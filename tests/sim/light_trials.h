// SPDX-License-Identifier: GPL-3.0-or-later
// The light of a run as numbers: lamps of the twin, and what patch, tiles and lux sensor of the
// reference profile make of them, without a picture. What the light gate says to it, by the
// hundred thousand.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "capture/light_gate.h"
#include "capture/sensor_watch.h"
#include "devices/twin/lamp.h"

namespace patina::testing {

enum class LightFault {
  kNone,
  kStep,     // of the lamp, relative
  kDrift,    // share a day
  kDead,     //
  kRipple,   // amplitude from shot to shot, relative: a dimmer's frequency changed
  kColour,   // du'v', at the same luminance
  kShadow,   // share of the light missing on a sixth of the specimen
  kSoiled,   // share of the patch's light missing, over all of it
  kStuck,    // the lux sensor says what it said
  kLampSwap  // by how much the shading of the other lamp differs, RMS; the patch sees the same
};
const char* name(LightFault fault);

struct LightTrial {
  LightFault fault = LightFault::kNone;
  double size = 0;
  Nanoseconds interval{};
  int quiet_shots = 30, faulty_shots = 12;
  std::uint64_t seed = 1;
};
struct LightOutcome {
  int false_alarms = 0;  // told of, or held, while all was well
  int delay_shots = 0;   // 1: on the first shot it touches; 0: never told
  bool right = false;    // by the answer that the fault has
  std::string said;      // first
};

// A rig with a patch of 64x64 pixels, a lux sensor, lamps that are warm; pictures of 512x512.
class LightSeriesMaker {
 public:
  explicit LightSeriesMaker(const LightTrial& trial);
  Nanoseconds at(int shot) const;
  capture::LightSample shoot(int shot, const std::string& state);
  capture::SensorSample rest(int shot) const;  // before a step: lamps off
  double trueLevel(int shot) const;            // of lamp `key`, over the exposure

 private:
  bool faulty(int shot) const { return shot >= trial_.quiet_shots; }
  double draw(int shot, std::uint64_t what) const;
  const devices::twin::Lamp& lampOf(int shot, const std::string& state) const;
  capture::PatchSample patch(int shot, double level) const;
  calibration::TileLevels tiles(int shot, double level, bool fill_lit) const;
  double lux(int shot, const devices::twin::Lamp& lamp) const;

  LightTrial trial_;
  devices::FaultPlan faults_;
  std::vector<devices::twin::Lamp> lamps_;
  std::array<double, 3> colour_{1, 1, 1};
  std::vector<double> albedo_, change_a_day_;  // of the tiles
};

// Runs one trial until it is told of, or to its end.
LightOutcome tryLight(const LightTrial& trial);

// Of a drift: what the gains that were stored leave of it.
struct DriftOutcome {
  double rms = 0, bias_end = 0;  // relative to the run's mean; of its last tenth
  int alarms = 0, corrected = 0, shots = 0;
};
DriftOutcome tryDrift(const LightTrial& trial, int shots);

}  // namespace patina::testing
