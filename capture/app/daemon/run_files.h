// SPDX-License-Identifier: GPL-3.0-or-later
// What a run is made of: its plan, its rig and the faults of its twin, checked against one another;
// and the living devices of it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "capture/plan.h"
#include "capture/session.h"
#include "db/archive.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::daemon {

struct RunFiles {
  capture::Plan plan;
  devices::RigSpec rig;
  devices::FaultPlan faults;  // of the twin; empty otherwise
};
// `seed` replaces the plan's. Throws devices::ConfigError.
RunFiles readRunFiles(const std::filesystem::path& plan, std::optional<std::uint64_t> seed);
// Plan and rig as they were when the run began, whatever their files say now. `plan` is where the
// plan lay: the faults of a twin are looked for from there.
RunFiles runFilesOf(const db::RunRow& run, const std::filesystem::path& plan);

// Of several runs on one rig each gets its own part: cameras and lights that no sweep names leave
// the rig, so that this run never touches them. Sensors stay: reading disturbs nobody.
void keepOnlyPlanned(RunFiles& files);
// The cameras and lights that nobody else may use while the run is unfinished.
std::vector<std::string> claimsOf(const RunFiles& files);

// Throws Failure(kUnavailable) for a backend this build has not.
devices::Rig openRig(const RunFiles& files, const capture::RunStart& start, devices::Clock& clock);

// The same for a rehearsal: Failure(kUnavailable) for a rig with any real device.
devices::Rig openTwinOnly(const RunFiles& files, const capture::RunStart& start,
                          devices::Clock& clock);

}  // namespace patina::daemon
