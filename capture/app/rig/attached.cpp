// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/attached.h"

#include <future>

#include "devices/host/driver_link.h"

namespace patina::rig {

void markTwins(std::vector<devices::FoundDevice>& devices) {
  for (devices::FoundDevice& one : devices)
    for (const devices::FoundDevice& other : devices)
      if (&one != &other && one.kind == other.kind && one.backend == other.backend &&
          one.model == other.model && one.serial == other.serial) {
        one.troubles.push_back({true,
                                "cannot be told from the other " + one.model + " at " +
                                    other.address +
                                    (one.serial.empty() ? ": neither gives a serial number"
                                                        : ": both say serial " + one.serial),
                                "use one of them alone, or bodies of different models"});
        break;
      }
}

Attached findAll(Nanoseconds limit, const std::vector<std::string>& command) {
  const std::vector<std::string> host =
      command.empty() ? std::vector<std::string>{"/proc/self/exe", "device-host"} : command;
  using Found = devices::Result<std::vector<devices::FoundDevice>>;
  std::vector<std::pair<std::string, std::future<Found>>> looking;
  for (const Backend& backend : backends())
    if (backend.find)
      looking.emplace_back(backend.name, std::async(std::launch::async, [=, name = backend.name] {
                             return devices::host::findInProcess(host, name, limit);
                           }));
  Attached all;
  for (auto& [backend, found] : looking) {
    Found devices = found.get();
    if (!devices) {
      all.failures.emplace_back(backend, devices.error().what);
      continue;
    }
    for (devices::FoundDevice& device : *devices) all.devices.push_back(std::move(device));
  }
  markTwins(all.devices);
  return all;
}

}  // namespace patina::rig
