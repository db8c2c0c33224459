// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "devices/rig.h"

namespace patina::devices::twin::dslr {

// A rig whose devices are driven by whatever backends, as the twin's world has it: what is said of
// lamps as things in a room stays, what is said to their drivers (hosts, channels) goes.
RigSpec worldRig(RigSpec rig);

}  // namespace patina::devices::twin::dslr
