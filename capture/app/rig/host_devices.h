// SPDX-License-Identifier: GPL-3.0-or-later
// Puts the real devices of a rig into processes of their own, here or on other machines.
#pragma once

#include <string>
#include <vector>

#include "capture/app/rig/make_devices.h"
#include "devices/host/server.h"

namespace patina::rig {

// The devices of a hello: what `patina device-host` serves.
devices::Rig makeHosted(const devices::host::Hello& hello, devices::Clock& clock);

// Twin devices live in this process, unless the rig says hosted. Every camera has a process of its
// own; lamps, sensors and shutter lines share one where they hang on the same port, board or line.
// `command` starts such a process; empty: this program's `device-host`. The clock outlives the rig.
devices::Rig openHosted(const devices::RigSpec& spec, const World& world, devices::Clock& clock,
                        const std::vector<std::string>& command = {});

}  // namespace patina::rig
