// SPDX-License-Identifier: GPL-3.0-or-later
// The words of the contracts' enumerations, as logs, files and reports spell them.
#include "devices/camera.h"
#include "devices/result.h"
#include "devices/sensor.h"

namespace patina::devices {

const char* name(Errc code) {
  switch (code) {
    case Errc::kBusy:
      return "busy";
    case Errc::kTimeout:
      return "timeout";
    case Errc::kLost:
      return "lost";
    case Errc::kCorrupt:
      return "corrupt";
    case Errc::kUnsupported:
      return "unsupported";
    case Errc::kRefused:
      return "refused";
  }
  return "unknown";
}

const char* name(Rung rung) {
  switch (rung) {
    case Rung::kRetry:
      return "retry";
    case Rung::kDrain:
      return "drain";
    case Rung::kReopen:
      return "reopen";
    case Rung::kReset:
      return "reset";
    case Rung::kPowerCycle:
      return "power_cycle";
  }
  return "unknown";
}

const char* name(Quantity q) {
  switch (q) {
    case Quantity::kIlluminance:
      return "illuminance";
    case Quantity::kTemperature:
      return "temperature";
    case Quantity::kHumidity:
      return "humidity";
  }
  return "unknown";
}

const char* unit(Quantity q) {
  switch (q) {
    case Quantity::kIlluminance:
      return "lx";
    case Quantity::kTemperature:
      return "degC";
    case Quantity::kHumidity:
      return "%";
  }
  return "unknown";
}

}  // namespace patina::devices
