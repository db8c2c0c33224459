// SPDX-License-Identifier: GPL-3.0-or-later
// How a camera's bus and socket help it up: the ladder's upper rungs, where the rig has them.
#pragma once

#include "devices/host/rungs.h"
#include "devices/rig.h"

namespace patina::rig {

// What a power cycle waits for the hardware.
inline constexpr Nanoseconds kPowerOff = std::chrono::seconds(3);    // until capacitors are empty
inline constexpr Nanoseconds kPowerOnset = std::chrono::seconds(2);  // until the kernel knows it

// USB reset for a camera with a serial on USB; the power that its `power` names. Throws what makers
// of devices throw. The clock outlives them.
devices::host::Rungs rungsOf(const devices::CameraSpec& spec, const devices::RigSpec& rig,
                             devices::Clock& clock);

}  // namespace patina::rig
