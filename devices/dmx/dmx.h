// SPDX-License-Identifier: GPL-3.0-or-later
// Lamps on a DMX line behind the network: backends "artnet" and "sacn". One-way: what a lamp did
// only a sensor or a patch can tell.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/found.h"
#include "devices/rig.h"

namespace patina::devices::dmx {

// address: the node's IPv4 address (sacn: empty = multicast). Names are refused: a silent name
// server would hold the rig. Settings: universe, channel | channels = "1,2,3", bits = 8 | 16 (a
// channel and the next one, coarse first), full (level at full, 0 to 1), port, interface; sacn:
// priority, source; and those of light_settings.h. Lamps of one universe share its sender while
// they live, in one process. Throws ConfigError; opens nothing.
std::unique_ptr<Light> makeLight(const LightSpec& spec, const std::filesystem::path& rig_file,
                                 Clock& clock);

// Lamps with the same answer must live in one process: two senders of one universe fight.
std::string sharedLine(const LightSpec& spec);

}  // namespace patina::devices::dmx
