// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/rig/attached.h"

#include <future>

#include "capture/app/rig/host_devices.h"
#include "capture/failure.h"
#include "devices/host/driver_link.h"

namespace patina::rig {
namespace {

constexpr Nanoseconds kLookLimit = std::chrono::seconds(10);

std::string camerasOf(const Attached& all) {
  std::string text;
  for (const devices::FoundDevice& device : all.devices) {
    if (device.kind != "camera") continue;
    if (!text.empty()) text += ", ";
    text.append(device.backend).append(" '").append(device.model).append("'");
    if (!device.serial.empty()) text.append(" serial ").append(device.serial);
    text.append(" at ").append(device.address);
    if (!device.state.empty()) text.append(" (").append(device.state).append(")");
  }
  return text.empty() ? "no camera that can be looked for" : text;
}

}  // namespace

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

void requireCameras(const devices::RigSpec& spec, devices::Clock& clock,
                    const std::vector<std::string>& command) {
  std::vector<std::string> real;
  for (const devices::CameraSpec& camera : spec.cameras)
    if (camera.backend != kTwinBackend) real.push_back(camera.id);
  if (real.empty()) return;
  std::string missing;
  {
    devices::Rig rig = openHosted(onlyThese(spec, real), {}, clock, command);
    std::vector<std::future<devices::Result<void>>> opening;
    for (const auto& camera : rig.cameras)
      opening.push_back(std::async(std::launch::async,
                                   [&camera] { return camera->recover(devices::Rung::kReopen); }));
    for (std::size_t i = 0; i < opening.size(); ++i)
      if (const auto opened = opening[i].get(); !opened)
        missing.append("camera '")
            .append(real[i])
            .append("' cannot be opened (")
            .append(opened.error().what)
            .append("). ");
  }
  if (missing.empty()) return;
  throw capture::CaptureError(
      Exit::kUnavailable, missing + "Attached: " + camerasOf(findAll(kLookLimit, command)) +
                              ". Switch it on or mend the rig file (`patina devices` shows what "
                              "to write); --wait begins all the same and waits for it");
}

}  // namespace patina::rig
