// SPDX-License-Identifier: GPL-3.0-or-later
// What a rig file may say of any lamp, whatever drives it.
#pragma once

#include "devices/light.h"
#include "devices/settings.h"

namespace patina::devices {

// kind = "led" | "incandescent", mains_hz = 50 | 60, warm_up = "5min". `confirms` stays false.
LightCaps takeLightCaps(Settings& settings, const std::string& id);
// kRefused for a level outside of [0,1]; `who` begins the message: "artnet 'key'".
Result<void> checkLevel(double level, const std::string& who);

}  // namespace patina::devices
