// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/sensor_settings.h"

#include <algorithm>
#include <cmath>

#include "devices/config_file.h"

namespace patina::devices {

using namespace std::chrono_literals;

SensorCaps takeSensorCaps(Settings& settings, const SensorSpec& spec) {
  constexpr double kFar = 1e9;
  const bool lux = spec.quantity == Quantity::kIlluminance;
  const bool temperature = spec.quantity == Quantity::kTemperature;
  SensorCaps caps;
  caps.id = spec.id;
  caps.quantity = spec.quantity;
  caps.minimum = settings.takeNumber("minimum", -kFar, kFar, temperature ? -40 : 0);
  caps.maximum = settings.takeNumber("maximum", -kFar, kFar,
                                     lux           ? 120'000
                                     : temperature ? 85
                                                   : 100);
  caps.integration = settings.takeDuration("integration", 0s, 60s, 100ms);
  if (!(caps.minimum < caps.maximum)) settings.reject("maximum", "is not above minimum");
  return caps;
}

SensorScale takeSensorScale(Settings& settings) {
  SensorScale scale;
  scale.scale = settings.takeNumber("scale", -1e9, 1e9, 1);
  scale.offset = settings.takeNumber("offset", -1e9, 1e9, 0);
  if (scale.scale == 0) settings.reject("scale", "must not be 0");
  return scale;
}

Result<Reading> readingOf(double value, const SensorCaps& caps, const Clock& clock) {
  if (!std::isfinite(value)) return fail(Errc::kCorrupt, "the value is no finite number");
  Reading reading;
  const bool low_end =
      caps.quantity == Quantity::kTemperature ? value <= caps.minimum : value < caps.minimum;
  reading.saturated = low_end || value >= caps.maximum;
  reading.value = std::clamp(value, caps.minimum, caps.maximum);
  reading.utc = clock.utc();
  reading.mono = clock.mono();
  return reading;
}

}  // namespace patina::devices
