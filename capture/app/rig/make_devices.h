// SPDX-License-Identifier: GPL-3.0-or-later
// Devices of a rig in the process that will call their drivers.
#pragma once

#include <string>
#include <vector>

#include "capture/app/rig/backends.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::rig {

inline constexpr const char* kTwinBackend = "twin";

// The twin's part of a rig is its world: seed, duration and start are of the run.
struct World {
  std::uint64_t seed = 1;
  Nanoseconds duration{};
  UtcTime start_utc{};
  devices::FaultPlan faults;  // those that act in the world
};

// The rig with these devices of it only, in its own order; the rest of the file as it is.
devices::RigSpec onlyThese(devices::RigSpec spec, const std::vector<std::string>& ids);

// A [[power]] of the rig.
std::unique_ptr<devices::Light> makeRelay(const devices::LightSpec& spec,
                                          const devices::RigSpec& rig, devices::Clock& clock);

// All devices of `spec`, closed. Cameras climb to the rungs of the USB bus and of their power
// switch here. Throws Failure(kUnavailable) for a backend this build has not, ConfigError for
// settings.
devices::Rig makeDevices(const devices::RigSpec& spec, const World& world, devices::Clock& clock);

}  // namespace patina::rig
