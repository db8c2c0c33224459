// SPDX-License-Identifier: GPL-3.0-or-later
// Lux, temperature, humidity: one number with its unit and quality.
#pragma once

#include <string>

#include "devices/clock.h"
#include "devices/result.h"

namespace patina::devices {

enum class Quantity { kIlluminance, kTemperature, kHumidity };
const char* name(Quantity q);  // "illuminance" ...
const char* unit(Quantity q);  // "lx" "degC" "%"

struct SensorCaps {
  std::string id;
  Quantity quantity = Quantity::kIlluminance;
  double minimum = 0, maximum = 0;  // of its range, in unit(quantity)
  Nanoseconds integration{};
};
struct Reading {
  double value = 0;  // in unit(quantity)
  UtcTime utc;
  MonoTime mono;
  bool saturated = false;
};

class Sensor {  // Thread-bound.
 public:
  virtual ~Sensor() = default;
  virtual const SensorCaps& caps() const = 0;
  virtual Result<Reading> read() = 0;
  virtual Result<void> recover() = 0;
};

}  // namespace patina::devices
