// SPDX-License-Identifier: GPL-3.0-or-later
// Sensors that the kernel itself reads: backends "iio" (Linux IIO) and "hwmon".
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/clock.h"
#include "devices/found.h"
#include "devices/rig.h"

namespace patina::devices::iio {

// Settings: name ("tsl2591"), label, path (a part of the device's place on its bus, "i2c-1/1-0039":
// numbers like iio:device0 change with every boot), channel ("in_illuminance0", "temp1"; without it
// the first of the quantity), timeout, scale and offset on top of the kernel's, and those of
// sensor_settings.h. `root` stands in place of "/". Throws ConfigError; opens nothing.
std::unique_ptr<Sensor> makeSensor(const SensorSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock, std::filesystem::path root = "/");

// Every channel of a quantity that Patina knows, with what it reads now.
std::vector<FoundDevice> find(const std::filesystem::path& root = "/");

}  // namespace patina::devices::iio
