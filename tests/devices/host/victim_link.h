// SPDX-License-Identifier: GPL-3.0-or-later
// Links to a host_victim that misbehaves as its test asks.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/host/driver_link.h"
#include "devices/host/hosted_devices.h"
#include "tests/contract/stub_devices.h"
#include "tests/support/temp_folder.h"

namespace patina::devices::host {

inline std::string victimProgram() {
  return (std::filesystem::read_symlink("/proc/self/exe").parent_path() / "host_victim").string();
}

inline LinkOptions victimOptions(const std::string& fault, const std::string& file = "") {
  LinkOptions options;
  options.name = "driver of 'cam0'";
  options.command = {victimProgram(), fault};
  if (!file.empty()) options.command.push_back(file);
  options.hello.devices = {"cam0", "key", "air", "line"};
  return options;
}

// One hosted camera and all it needs.
struct HostedBench {
  explicit HostedBench(const std::string& fault, CameraLimits limits = {})
      : link(std::make_shared<DriverLink>(victimOptions(fault, folder / "seen"), clock)),
        camera(makeHostedCamera(patina::testing::makeStubCamera("cam0", clock)->caps(), link, 0,
                                limits, clock)) {}

  // A shot whose picture is waited for this long.
  Result<std::vector<RawFrame>> shoot(Nanoseconds wait) {
    const auto ticket = camera->trigger({"run/1", ++sequence});
    if (!ticket) return tl::make_unexpected(ticket.error());
    return camera->collect(*ticket, clock.mono() + wait);
  }

  patina::testing::TempFolder folder = patina::testing::TempFolder::inMemory();
  RealClock clock;
  std::shared_ptr<DriverLink> link;
  std::unique_ptr<Camera> camera;
  std::uint64_t sequence = 0;
};

}  // namespace patina::devices::host
