// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault_plan.h"

#include <algorithm>
#include <array>
#include <map>

#include "devices/config_file.h"
#include "devices/config_guard.h"
#include "devices/rig.h"

namespace patina::devices {
namespace {

struct KindName {
  FaultKind kind;
  const char* name;
};
constexpr std::array kKinds{KindName{FaultKind::kHang, "hang"},
                            KindName{FaultKind::kBusy, "busy"},
                            KindName{FaultKind::kLost, "lost"},
                            KindName{FaultKind::kPartialFile, "partial_file"},
                            KindName{FaultKind::kDuplicate, "duplicate"},
                            KindName{FaultKind::kLate, "late"},
                            KindName{FaultKind::kStaleFrame, "stale_frame"},
                            KindName{FaultKind::kWrongSize, "wrong_size"},
                            KindName{FaultKind::kCorruptBytes, "corrupt_bytes"},
                            KindName{FaultKind::kLampDead, "lamp_dead"},
                            KindName{FaultKind::kLampDrift, "lamp_drift"},
                            KindName{FaultKind::kLampStep, "lamp_step"},
                            KindName{FaultKind::kSensorSilent, "sensor_silent"},
                            KindName{FaultKind::kPowerCut, "power_cut"}};

std::vector<std::string> kindNames() {
  std::vector<std::string> names;
  for (const KindName& known : kKinds) names.emplace_back(known.name);
  return names;
}

Fault takeFault(ConfigTable& table) {
  Fault fault;
  fault.at = table.takeDuration("at", Nanoseconds{0}, kFaultForEver);
  fault.device = table.takeId("device");
  fault.kind = parseFaultKind(table.takeChoice("kind", kindNames()));
  fault.line = table.line();
  const bool of_lamp = isLampFault(fault.kind),
             changes_level = of_lamp && fault.kind != FaultKind::kLampDead;
  fault.duration =
      of_lamp ? table.takeDuration("duration", Nanoseconds{1}, kFaultForEver, kFaultForEver)
              : table.takeDuration("duration", Nanoseconds{0}, kFaultForEver, Nanoseconds{0});
  if (changes_level) fault.amount = table.takeNumber("amount", -1, 10);
  table.finish();
  return fault;
}

}  // namespace

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
  for (const KindName& known : kKinds) {
    if (name == known.name) return known.kind;
  }
  throw Failure(Exit::kConfig, '"' + name + "\" is no kind of fault");
}

const char* name(FaultKind kind) {
  for (const KindName& known : kKinds) {
    if (kind == known.kind) return known.name;
  }
  return "unknown";
}

bool isLampFault(FaultKind kind) {
  return kind == FaultKind::kLampDead || kind == FaultKind::kLampDrift ||
         kind == FaultKind::kLampStep;
}

void checkAgainst(const FaultPlan& plan, const RigSpec& rig) {
  enum class Device { kCamera, kLight, kSensor };
  std::map<std::string, Device> devices;
  for (const CameraSpec& camera : rig.cameras) devices.emplace(camera.id, Device::kCamera);
  for (const LightSpec& light : rig.lights) devices.emplace(light.id, Device::kLight);
  for (const SensorSpec& sensor : rig.sensors) devices.emplace(sensor.id, Device::kSensor);
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
    const Device owner = isLampFault(fault.kind)                  ? Device::kLight
                         : fault.kind == FaultKind::kSensorSilent ? Device::kSensor
                                                                  : Device::kCamera;
    if (!of_any && found->second != owner) {
      throw ConfigError(plan.source, fault.line, "fault.kind",
                        std::string(name(fault.kind)) + " cannot happen to '" + fault.device + "'");
    }
  }
}

}  // namespace patina::devices
