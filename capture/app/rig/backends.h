// SPDX-License-Identifier: GPL-3.0-or-later
// Every way to reach a device, by the name a rig file calls it. The twin is no row here: it makes
// whole rigs.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "devices/found.h"
#include "devices/rig.h"

namespace patina::rig {

// What a backend has not is empty. Makers touch no hardware; they throw ConfigError for settings
// they do not know. find() says of a sick device what is wrong with it, and throws for none.
struct Backend {
  template <class Device, class Spec>
  using Maker = std::function<std::unique_ptr<Device>(const Spec&, const std::filesystem::path& rig,
                                                      devices::Clock&)>;
  std::string name;
  Maker<devices::Camera, devices::CameraSpec> camera{};
  Maker<devices::Light, devices::LightSpec> light{};
  Maker<devices::Sensor, devices::SensorSpec> sensor{};
  Maker<devices::Trigger, devices::TriggerSpec> trigger{};
  std::function<std::vector<devices::FoundDevice>()> find{};
  // Lamps with the same answer must share a process; nothing: those of one address do.
  std::function<std::string(const devices::LightSpec&)> shared_line{};
};

const std::vector<Backend>& backends();
// What the backend of that name sees attached, in this process. Failure(kUsage): no such backend.
std::vector<devices::FoundDevice> findAttached(const std::string& backend);
// Nothing, when there is none of that name.
const Backend* backendNamed(const std::string& name);

}  // namespace patina::rig
