// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps and shutter lines on GPIO: backend "gpio", address "CHIP:LINE" ("pinctrl-bcm2711:17").
#pragma once

#include <filesystem>
#include <memory>
#include <vector>

#include "devices/clock.h"
#include "devices/found.h"
#include "devices/gpio/output_line.h"
#include "devices/rig.h"

namespace patina::devices::gpio {

// Settings: active = "high" | "low", and those of light_settings.h. One-way: the pin is read back,
// what hangs on it is not. Throws ConfigError; opens nothing.
std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock, const RequestLine& request = requestLine);
// Settings: active, half_line (a line of the same chip), and those of trigger_pulse.h.
std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock, const RequestLine& request = requestLine);

std::vector<FoundDevice> find();  // the chips (kind "port")

}  // namespace patina::devices::gpio
