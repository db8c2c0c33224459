// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps, shutter lines and sensors on a serial port: backend "serial". `address`, or `port` among a
// sensor's settings, is the path of the port. No factory opens anything; all throw ConfigError.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/found.h"
#include "devices/rig.h"
#include "devices/serial/port.h"

namespace patina::devices::serial {

// Of a lamp, either `on` and `off`, what to send ("REL1.ON\n", "\xA0\x01\x01\xA2"; {level} in `on`
// stands for 0 to `levels`), with on_reply and off_reply, what must come back, or ask, ask_on and
// ask_off, how to ask for its state: a lamp that answers confirms. Or `line` = "rts" | "dtr" and
// `active` = "high" | "low". And baud, boot, timeout, and those of light_settings.h.
std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock);
// `line`, `active`, `half_line` and those of trigger_pulse.h; or `fire`, what to send, with
// `reply`.
std::unique_ptr<Trigger> makeTrigger(const TriggerSpec& spec, const std::filesystem::path& rig_file,
                                     Clock& clock);
// `port`, baud, boot; `ask`, what to send, or without it a sensor that speaks by itself; `pattern`,
// the text around {value}; max_age, the longest wait for a line; and those of sensor_settings.h.
std::unique_ptr<Sensor> makeSensor(const SensorSpec& spec, const std::filesystem::path& rig_file,
                                   Clock& clock);

// The ports with a stable name, each what could carry a device (kind "port").
std::vector<FoundDevice> find(const std::filesystem::path& root = "/");

// The same over a given port, for tests and for what speaks lines by another way.
std::unique_ptr<Light> makeLightOn(std::shared_ptr<Port> port, const LightSpec& spec,
                                   const std::filesystem::path& rig_file, Clock& clock);
std::unique_ptr<Trigger> makeTriggerOn(std::shared_ptr<Port> port, const TriggerSpec& spec,
                                       const std::filesystem::path& rig_file, Clock& clock);
std::unique_ptr<Sensor> makeSensorOn(std::shared_ptr<Port> port, const SensorSpec& spec,
                                     const std::filesystem::path& rig_file, Clock& clock);

}  // namespace patina::devices::serial
