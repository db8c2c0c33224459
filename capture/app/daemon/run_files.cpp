// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_files.h"

#include <algorithm>
#include <set>

#include "capture/app/rig/host_devices.h"
#include "devices/fault/faulty_devices.h"

namespace patina::daemon {
namespace {

void takeFaults(RunFiles& files) {
  if (files.rig.twin && files.rig.twin->faults)
    files.faults = devices::readFaults(*files.rig.twin->faults);
  devices::checkAgainst(files.faults, files.rig);
}

}  // namespace

RunFiles readRunFiles(const std::filesystem::path& plan, std::optional<std::uint64_t> seed) {
  RunFiles files;
  files.plan = capture::readPlan(plan);
  files.rig = devices::readRig(files.plan.rig_file);
  capture::checkAgainst(files.plan, files.rig);
  if (seed) files.plan.seed = *seed;
  takeFaults(files);
  return files;
}

RunFiles runFilesOf(const db::RunRow& run, const std::filesystem::path& plan) {
  RunFiles files;
  files.plan = capture::parsePlan(run.plan_toml, plan);
  files.plan.seed = run.seed;
  files.rig = devices::parseRig(run.rig_toml, files.plan.rig_file);
  capture::checkAgainst(files.plan, files.rig);
  takeFaults(files);
  return files;
}

void keepOnlyPlanned(RunFiles& files) {
  std::set<std::string> cameras, lights;
  for (const capture::Sweep& sweep : files.plan.sweeps) {
    for (const std::string& id : capture::camerasOf(sweep, files.rig)) cameras.insert(id);
    for (const auto& state : sweep.lights) lights.insert(state.begin(), state.end());
  }
  devices::RigSpec& rig = files.rig;
  std::erase_if(rig.cameras, [&](const auto& camera) { return !cameras.contains(camera.id); });
  std::erase_if(rig.lights, [&](const auto& light) { return !lights.contains(light.id); });
  std::erase_if(rig.patches, [&](const auto& patch) { return !cameras.contains(patch.camera); });
  std::erase_if(files.faults.faults, [&](const devices::Fault& fault) {
    const auto sensor = std::find_if(rig.sensors.begin(), rig.sensors.end(),
                                     [&](const auto& s) { return s.id == fault.device; });
    return !cameras.contains(fault.device) && !lights.contains(fault.device) &&
           sensor == rig.sensors.end() && fault.device != devices::kWholeRig &&
           fault.device != devices::kTheSpecimen;
  });
}

std::vector<std::string> claimsOf(const RunFiles& files) {
  std::vector<std::string> ids;
  for (const auto& camera : files.rig.cameras) ids.push_back(camera.id);
  for (const auto& light : files.rig.lights) ids.push_back(light.id);
  return ids;
}

devices::Rig openRig(const RunFiles& files, const capture::RunStart& start, devices::Clock& clock) {
  rig::World world;
  world.seed = files.plan.seed;
  world.duration = files.plan.duration;
  world.start_utc = start.t0_utc;
  world.faults = files.faults;
  devices::Rig rig = rig::openHosted(files.rig, world, clock);
  if (files.faults.faults.empty()) return rig;
  const MonoTime began = clock.mono() - (clock.utc() - start.t0_utc);
  return devices::withFaults(std::move(rig), files.faults, began, clock);
}

devices::Rig openTwinOnly(const RunFiles& files, const capture::RunStart& start,
                          devices::Clock& clock) {
  const auto require = [](const auto& all) {
    for (const auto& device : all)
      if (device.backend != rig::kTwinBackend)
        throw capture::CaptureError(Exit::kUnavailable,
                                    "'" + device.id + "' is a real device (" + device.backend +
                                        "): a rehearsal takes the twin alone; `patina capture` "
                                        "runs the plan");
  };
  require(files.rig.cameras);
  require(files.rig.lights);
  require(files.rig.sensors);
  require(files.rig.triggers);
  return openRig(files, start, clock);
}

}  // namespace patina::daemon
