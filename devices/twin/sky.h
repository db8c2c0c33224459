// SPDX-License-Identifier: GPL-3.0-or-later
// Light that is not the rig's: of a room, or of the day for uncontrolled lighting.
#pragma once

#include <cstdint>

#include "devices/rig.h"
#include "devices/twin/lamp_field.h"

namespace patina::devices::twin {

// Levels are those of a lamp on a white card that lies flat in the middle.
struct Sky {
  double dome = 0;  // from all sides alike
  double sun = 0;   // 0: it is down, or behind the roof
  LampPlace sun_place;
};

// kRoom: a dome of 0.15, always. kDaylight: an open shed at 45 degrees north in late summer, noon
// at 12:00 UTC, the sun from the south (-y), with seeded clouds that pass in some ten minutes: sun
// up to 0.9, dome 0.1 to 0.5, nothing at night. Pure.
Sky skyAt(Surroundings surroundings, std::uint64_t seed, UtcTime utc);

}  // namespace patina::devices::twin
