// SPDX-License-Identifier: GPL-3.0-or-later
// What a rig file may say of any sensor, and what becomes of a number it answers.
#pragma once

#include "devices/rig.h"
#include "devices/settings.h"

namespace patina::devices {

// Value = number * scale + offset, in unit() of the quantity.
struct SensorScale {
  double scale = 1, offset = 0;
};

// minimum, maximum (in unit(quantity); without them what common sensors reach), integration.
SensorCaps takeSensorCaps(Settings& settings, const SensorSpec& spec);
SensorScale takeSensorScale(Settings& settings);

// Now, by `clock`. A value at or beyond the end of the range is held there and saturated; no light
// and dry air are readings, the coldest temperature a sensor knows is not. kCorrupt for NaN.
Result<Reading> readingOf(double value, const SensorCaps& caps, const Clock& clock);

}  // namespace patina::devices
