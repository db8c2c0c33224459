// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/faults_file.h"

#include <algorithm>

#include "devices/fault_table.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr double kShareMax = 0.999;

std::vector<std::string> kindNames() {
  std::vector<std::string> names;
  for (const DslrFaultKind kind : allDslrFaults()) names.emplace_back(name(kind));
  return names;
}

std::vector<std::string> operationNames() {
  std::vector<std::string> names;
  for (const Operation operation : allOperations()) names.emplace_back(name(operation));
  return names;
}

template <class Named>
Named named(const std::vector<Named>& all, const std::string& wanted) {
  return *std::ranges::find_if(all, [&](Named one) { return wanted == name(one); });
}

DslrFault takeDslrFault(ConfigTable& table) {
  DslrFault fault;
  fault.at = table.takeDuration("at", Nanoseconds{0}, kFaultForEver);
  table.takeId("device");
  fault.kind = named(allDslrFaults(), table.takeChoice("kind", kindNames()));
  fault.duration = table.takeDuration("duration", Nanoseconds{0}, kFaultForEver, Nanoseconds{0});
  fault.amount = table.takeNumber("amount", 0, kShareMax, 0);
  if (table.has("operation"))
    fault.operation = named(allOperations(), table.takeChoice("operation", operationNames()));
  table.finish();
  return fault;
}

}  // namespace

DslrScript readDslrFaults(const std::filesystem::path& file, const RigSpec& rig,
                          const std::string& camera) {
  return parseDslrFaults(ConfigFile::readText(file), file, rig, camera);
}

DslrScript parseDslrFaults(const std::string& toml, const std::filesystem::path& source,
                           const RigSpec& rig, const std::string& camera) {
  ConfigTable file = ConfigFile::parse(toml, source);
  DslrScript script;
  script.world.source = source;
  script.world.seed = static_cast<std::uint64_t>(file.takeInteger("seed", 0, INT64_MAX, 1));
  const auto kinds = kindNames();
  for (ConfigTable& table : file.takeTables("fault")) {
    const std::string kind = table.takeString("kind");
    if (std::ranges::find(kinds, kind) != kinds.end()) {
      if (table.takeId("device") != camera)
        table.reject("device", "only the virtual DSLR '" + camera + "' can " + kind);
      script.camera.push_back(takeDslrFault(table));
      continue;
    }
    const Fault fault = takeFault(table);
    if (!happensInWorld(fault.kind))
      table.reject("kind", '"' + kind +
                               "\" does not happen to a virtual DSLR, whose driver is "
                               "what is tested; what does: refuse, busy, stall, reset, "
                               "close, events_late and the others of its README");
    script.world.faults.push_back(fault);
  }
  file.finish();
  checkAgainst(script.world, rig);
  return script;
}

}  // namespace patina::devices::twin::dslr
