// SPDX-License-Identifier: GPL-3.0-or-later
// The simulated rig. One world holds specimen, lamps, sensors and cameras together, so that a dead
// lamp gives a dark picture. Everything is a pure function of seed, profile and time.
#pragma once

#include <cstdint>
#include <memory>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::devices::twin {

struct TwinOptions {
  std::uint64_t seed = 1;
  Nanoseconds duration{};  // of the specimen's whole process: the run's length
  UtcTime start_utc;       // when the process begins: the run's t0, also after a restart
  FaultPlan faults;        // lamp faults act in the world; device faults by the decorators
};

// A whole rig of backend "twin" devices on one world. Throws ConfigError for a specimen, setting
// or backend that is not there. The clock outlives the rig. Thread-bound as its devices are.
Rig makeTwinRig(const RigSpec& spec, const TwinOptions& options, Clock& clock);

}  // namespace patina::devices::twin
