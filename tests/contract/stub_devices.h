// SPDX-License-Identifier: GPL-3.0-or-later
// The smallest devices that keep the contracts, with none of a backend's physics: what the suite
// itself is tried on, and what tests of policy drive.
#pragma once

#include <memory>
#include <string>

#include "devices/camera.h"
#include "devices/clock.h"
#include "devices/light.h"
#include "devices/sensor.h"

namespace patina::testing {

// 16x12 PNG pictures that differ from shot to shot; a shot takes its exposure and 100 ms.
std::unique_ptr<devices::Camera> makeStubCamera(const std::string& id, devices::Clock& clock);
std::unique_ptr<devices::Light> makeStubLight(const std::string& id);
// Always 20 degC.
std::unique_ptr<devices::Sensor> makeStubSensor(const std::string& id, devices::Clock& clock);

}  // namespace patina::testing
