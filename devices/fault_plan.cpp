// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault_plan.h"

#include <algorithm>
#include <array>

#include "devices/config_file.h"

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
                            KindName{FaultKind::kSensorSilent, "sensor_silent"}};

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
  const bool changes_level =
      fault.kind == FaultKind::kLampDrift || fault.kind == FaultKind::kLampStep;
  const bool of_lamp = changes_level || fault.kind == FaultKind::kLampDead;
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

}  // namespace patina::devices
