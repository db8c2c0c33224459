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
  // lamps (the twin's world sees these, so that a dead lamp gives a dark picture)
  kLampDead,
  kLampDrift,
  kLampStep,
  // sensors
  kSensorSilent,
  // the whole rig (device "rig"): the power fails, what was not synced is lost. Rehearsals only.
  kPowerCut
};
// The device of a power cut.
constexpr const char* kWholeRig = "rig";

// A lamp's fault without a duration lasts until the end of the run.
constexpr Nanoseconds kFaultForEver = std::chrono::hours(24 * 4000);

struct Fault {
  Nanoseconds at{};    // after the start of the run
  std::string device;  // id of the rig file
  FaultKind kind = FaultKind::kHang;
  Nanoseconds duration{};  // zero: one call, the first at or after `at`
  double amount = 0;       // kLampDrift: share a day; kLampStep: factor - 1; others unused
  int line = 0;            // of the faults file, for messages
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
bool isLampFault(FaultKind kind);
// A fault of a device that the rig has not, or of a kind that device cannot have: a ConfigError on
// the fault's line.
void checkAgainst(const FaultPlan& plan, const RigSpec& rig);

}  // namespace patina::devices
