// SPDX-License-Identifier: GPL-3.0-or-later
// Trouble on order: what goes wrong, where, when and for how long. Seeded, readable, repeatable.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::devices {

enum class FaultKind {
  // cameras
  kHang,          // collect returns nothing until its deadline
  kBusy,          // trigger answers busy
  kLost,          // every call answers lost until recover(kReset)
  kPartialFile,   // the file is cut short, its declared length is not
  kDuplicate,     // the file comes twice
  kLate,          // the picture comes with the NEXT shot's collect
  kStaleFrame,    // the previous picture, returned as new
  kWrongSize,     // a picture of another size
  kCorruptBytes,  // bytes flipped inside the file
  // What follows happens in the twin's world, so that a dead lamp gives a dark picture.
  // lamps
  kLampDead,
  kLampDrift,
  kLampStep,
  kWrongLamp,       // what is said to it reaches the next lamp of the rig file
  kLightsMirrored,  // it stands at -x of where the rig file has it
  // the view of a camera
  kCameraBumped,
  kFocusCreep,
  kCondensation,
  kHand,    // in the picture
  kInsect,  // walks through the picture
  kPatchSoiled,
  kPatchSnowed,
  kPatchOvergrown,
  // the specimen
  kSpecimenBumped,
  kSpecimenWarps,
  // sensors
  kSensorStuck,      // its first reading again and again
  kSensorSaturated,  // the most it can say
  // Not in the world:
  kSensorSilent,
  // the whole rig (device "rig"): the power fails, what was not synced is lost. Rehearsals only.
  kPowerCut
};
// The devices of a power cut, and of what happens to the specimen.
constexpr const char* kWholeRig = "rig";
constexpr const char* kTheSpecimen = "specimen";

// A fault of the world without a duration lasts until the end of the run.
constexpr Nanoseconds kFaultForEver = std::chrono::hours(24 * 4000);

struct Fault {
  Nanoseconds at{};    // after the start of the run
  std::string device;  // id of the rig file
  FaultKind kind = FaultKind::kHang;
  Nanoseconds duration{};  // zero: one call, the first at or after `at`
  // kLampDrift: share a day; kLampStep: factor - 1; kCameraBumped, kSpecimenBumped: mm along the
  // plane; kFocusCreep: pixels of blur (RMS radius) a day, which stay; kCondensation: share of the
  // light that fog scatters; kPatchSoiled, kPatchSnowed, kPatchOvergrown: share of the patch
  // covered; kSpecimenWarps: share it shrinks by, grain against grain; others unused.
  double amount = 0;
  int line = 0;  // of the faults file, for messages
};

struct FaultPlan {
  std::uint64_t seed = 1;
  std::vector<Fault> faults;
  std::filesystem::path source;
};

struct RigSpec;

// seed=1 and [[fault]] at="3d2h" device="cam0" kind="hang" [duration="40s"] [amount=-0.05]
FaultPlan readFaults(const std::filesystem::path& file);  // throws ConfigError
FaultPlan parseFaults(const std::string& toml, const std::filesystem::path& source);
FaultKind parseFaultKind(const std::string& name);  // "hang" "partial_file" "lamp_dead" ...
const char* name(FaultKind kind);
enum class FaultPlace { kCamera, kLight, kSensor, kSpecimen, kRig };
FaultPlace placeOf(FaultKind kind);  // kHang, kBusy, kLost: a camera; they may befall any device
bool happensInWorld(FaultKind kind);
// A fault of a device that the rig has not, or of a kind that device cannot have: a ConfigError on
// the fault's line.
void checkAgainst(const FaultPlan& plan, const RigSpec& rig);

}  // namespace patina::devices
