// SPDX-License-Identifier: GPL-3.0-or-later
// The twin's devices around one world. Private to the twin.
#pragma once

#include <memory>

#include "devices/rig.h"
#include "devices/twin/twin.h"
#include "devices/twin/world.h"

namespace patina::devices::twin {

std::unique_ptr<Camera> makeTwinCamera(std::shared_ptr<World> world, const CameraSpec& spec);
std::unique_ptr<Light> makeTwinLight(std::shared_ptr<World> world, std::size_t lamp);
std::unique_ptr<Sensor> makeTwinSensor(std::shared_ptr<World> world, const SensorSpec& spec);
std::unique_ptr<Trigger> makeTwinTrigger(std::shared_ptr<World> world, const TriggerSpec& spec);

// A device's stream of random numbers: its id under the world's seed.
std::uint64_t deviceSeed(const World& world, const std::string& id);

}  // namespace patina::devices::twin
