// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault_plan.h"

#include <algorithm>
#include <array>
#include <map>

#include "devices/config_file.h"
#include "devices/config_guard.h"
#include "devices/fault_table.h"
#include "devices/rig.h"

namespace patina::devices {
namespace {

struct KindFacts {
  FaultKind kind;
  const char* name;
  FaultPlace place;
  bool in_world;
  double least = 0, most = 0;  // of the amount; alike: it has none
};
constexpr std::array kKinds{
    KindFacts{FaultKind::kHang, "hang", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kBusy, "busy", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kLost, "lost", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kPartialFile, "partial_file", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kDuplicate, "duplicate", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kLate, "late", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kStaleFrame, "stale_frame", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kWrongSize, "wrong_size", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kCorruptBytes, "corrupt_bytes", FaultPlace::kCamera, false},
    KindFacts{FaultKind::kLampDead, "lamp_dead", FaultPlace::kLight, true},
    KindFacts{FaultKind::kLampDrift, "lamp_drift", FaultPlace::kLight, true, -1, 10},
    KindFacts{FaultKind::kLampStep, "lamp_step", FaultPlace::kLight, true, -1, 10},
    KindFacts{FaultKind::kWrongLamp, "wrong_lamp", FaultPlace::kLight, true},
    KindFacts{FaultKind::kLightsMirrored, "lights_mirrored", FaultPlace::kLight, true},
    KindFacts{FaultKind::kCameraBumped, "camera_bumped", FaultPlace::kCamera, true, 0, 1000},
    KindFacts{FaultKind::kFocusCreep, "focus_creep", FaultPlace::kCamera, true, 0, 1000},
    KindFacts{FaultKind::kCondensation, "condensation", FaultPlace::kCamera, true, 0, 1},
    KindFacts{FaultKind::kHand, "hand", FaultPlace::kCamera, true},
    KindFacts{FaultKind::kInsect, "insect", FaultPlace::kCamera, true},
    KindFacts{FaultKind::kPatchSoiled, "patch_soiled", FaultPlace::kCamera, true, 0, 1},
    KindFacts{FaultKind::kPatchSnowed, "patch_snowed", FaultPlace::kCamera, true, 0, 1},
    KindFacts{FaultKind::kPatchOvergrown, "patch_overgrown", FaultPlace::kCamera, true, 0, 1},
    KindFacts{FaultKind::kSpecimenBumped, "specimen_bumped", FaultPlace::kSpecimen, true, 0, 1000},
    KindFacts{FaultKind::kSpecimenWarps, "specimen_warps", FaultPlace::kSpecimen, true, 0, 0.5},
    KindFacts{FaultKind::kSensorStuck, "sensor_stuck", FaultPlace::kSensor, true},
    KindFacts{FaultKind::kSensorSaturated, "sensor_saturated", FaultPlace::kSensor, true},
    KindFacts{FaultKind::kSensorSilent, "sensor_silent", FaultPlace::kSensor, false},
    KindFacts{FaultKind::kPowerCut, "power_cut", FaultPlace::kRig, false}};

const KindFacts& factsOf(FaultKind kind) {
  return *std::ranges::find(kKinds, kind, &KindFacts::kind);
}

std::vector<std::string> kindNames() {
  std::vector<std::string> names;
  for (const KindFacts& known : kKinds) names.emplace_back(known.name);
  return names;
}

}  // namespace

Fault takeFault(ConfigTable& table) {
  Fault fault;
  fault.at = table.takeDuration("at", Nanoseconds{0}, kFaultForEver);
  fault.device = table.takeId("device");
  fault.kind = parseFaultKind(table.takeChoice("kind", kindNames()));
  fault.line = table.line();
  const KindFacts& facts = factsOf(fault.kind);
  fault.duration =
      facts.in_world
          ? table.takeDuration("duration", Nanoseconds{1}, kFaultForEver, kFaultForEver)
          : table.takeDuration("duration", Nanoseconds{0}, kFaultForEver, Nanoseconds{0});
  if (facts.least < facts.most) fault.amount = table.takeNumber("amount", facts.least, facts.most);
  table.finish();
  return fault;
}

FaultPlan readFaults(const std::filesystem::path& file) {
  return parseFaults(ConfigFile::readText(file), file);
}

FaultPlan parseFaults(const std::string& toml, const std::filesystem::path& source) {
  ConfigTable table = ConfigFile::parse(toml, source);
  FaultPlan plan;
  plan.source = source;
  plan.seed = static_cast<std::uint64_t>(table.takeInteger("seed", 0, INT64_MAX, 1));
  for (ConfigTable& fault : table.takeTables("fault")) plan.faults.push_back(takeFault(fault));
  table.finish();
  return plan;
}

FaultKind parseFaultKind(const std::string& name) {
  for (const KindFacts& known : kKinds) {
    if (name == known.name) return known.kind;
  }
  throw Failure(Exit::kConfig, '"' + name + "\" is no kind of fault");
}

const char* name(FaultKind kind) { return factsOf(kind).name; }
FaultPlace placeOf(FaultKind kind) { return factsOf(kind).place; }
bool happensInWorld(FaultKind kind) { return factsOf(kind).in_world; }

void checkAgainst(const FaultPlan& plan, const RigSpec& rig) {
  std::map<std::string, FaultPlace> devices{{kTheSpecimen, FaultPlace::kSpecimen}};
  for (const CameraSpec& camera : rig.cameras) devices.emplace(camera.id, FaultPlace::kCamera);
  for (const LightSpec& light : rig.lights) devices.emplace(light.id, FaultPlace::kLight);
  for (const SensorSpec& sensor : rig.sensors) devices.emplace(sensor.id, FaultPlace::kSensor);
  std::vector<std::string> ids;
  for (const auto& [id, device] : devices) ids.push_back(id);

  for (const Fault& fault : plan.faults) {
    if ((fault.kind == FaultKind::kPowerCut) != (fault.device == kWholeRig)) {
      throw ConfigError(plan.source, fault.line, "fault.kind",
                        "power_cut happens to the whole rig, and nothing else does: it goes with "
                        "device = \"rig\"");
    }
    if (fault.kind == FaultKind::kPowerCut) continue;
    const auto found = devices.find(fault.device);
    if (found == devices.end()) {
      const std::string nearest = nearestWord(fault.device, ids);
      throw ConfigError(plan.source, fault.line, "fault.device",
                        '"' + quoteForMessage(fault.device) +
                            "\" is no camera, light or sensor of the rig" +
                            (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
    }
    const bool of_any = fault.kind == FaultKind::kHang || fault.kind == FaultKind::kBusy ||
                        fault.kind == FaultKind::kLost;
    const bool fits =
        of_any ? found->second != FaultPlace::kSpecimen : found->second == placeOf(fault.kind);
    if (!fits) {
      throw ConfigError(plan.source, fault.line, "fault.kind",
                        std::string(name(fault.kind)) + " cannot happen to '" + fault.device + "'");
    }
  }
}

}  // namespace patina::devices
