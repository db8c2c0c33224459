// SPDX-License-Identifier: GPL-3.0-or-later
// The faults of a virtual DSLR and of its world, in the form of every faults file:
//   [[fault]] at = "90s"  device = "cam0"  kind = "stall"  duration = "5s"  [operation =
//   "GetObject"]
//             [amount = 0.5]
// Of its camera: the kinds of misbehaviour.h, with the operation it hits and the share of the reply
// that gets out before. Of its lamps, its view and its specimen: those of fault_plan.h that happen
// in the world.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "devices/fault_plan.h"
#include "devices/rig.h"
#include "devices/twin/dslr/misbehaviour.h"

namespace patina::devices::twin::dslr {

struct DslrScript {
  std::vector<DslrFault> camera;
  FaultPlan world;
};

// `camera`: its id in the rig. Both throw ConfigError.
DslrScript readDslrFaults(const std::filesystem::path& file, const RigSpec& rig,
                          const std::string& camera);
DslrScript parseDslrFaults(const std::string& toml, const std::filesystem::path& source,
                           const RigSpec& rig, const std::string& camera);

}  // namespace patina::devices::twin::dslr
