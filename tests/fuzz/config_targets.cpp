// SPDX-License-Identifier: GPL-3.0-or-later
// Plans, rigs, fault files and the daemon's own file.
#include "capture/app/daemon/daemon_config.h"
#include "capture/plan.h"
#include "devices/config_file.h"
#include "devices/fault_plan.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {
namespace {

const devices::RigSpec& smallRig() {
  static const devices::RigSpec kRig = devices::parseRig(
      "[[camera]]\nid = \"cam0\"\nbackend = \"twin\"\n[[light]]\nid = \"key\"\nbackend = "
      "\"twin\"\n",
      "rig.toml");
  return kRig;
}

}  // namespace

void fuzzPlan(std::span<const std::byte> bytes) {
  try {
    const capture::Plan plan = capture::parsePlan(textOf(bytes), "plan.toml");
    if (capture::slotCount(plan) < 100'000) capture::stepCount(plan);
    capture::shotsAStep(plan, smallRig());
    capture::checkAgainst(plan, smallRig());
  } catch (const devices::ConfigError&) {
    // Refused, with file, line and key.
  }
}

void fuzzRig(std::span<const std::byte> bytes) {
  try {
    const devices::RigSpec rig = devices::parseRig(textOf(bytes), "rig.toml");
    for (const auto& light : rig.lights)
      devices::lightsOfState(devices::lightStateName({light.id, "key"}));
  } catch (const devices::ConfigError&) {
    // Refused, with file, line and key.
  }
}

void fuzzFaults(std::span<const std::byte> bytes) {
  try {
    devices::checkAgainst(devices::parseFaults(textOf(bytes), "faults.toml"), smallRig());
  } catch (const devices::ConfigError&) {
    // Refused, with file, line and key.
  }
}

void fuzzDaemonConfig(std::span<const std::byte> bytes) {
  try {
    const auto config = daemon::parseDaemonConfig(textOf(bytes), "daemon.toml");
    PATINA_CHECK(config.port >= 0 && config.port <= 65535);
  } catch (const devices::ConfigError&) {
    // Refused, with file, line and key.
  }
}

}  // namespace patina::testing
