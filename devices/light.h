// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp that can be told on or off. Many are one-way: only a patch or sensor proves it obeyed.
#pragma once

#include <optional>
#include <string>

#include "devices/result.h"
#include "processing/image/units.h"

namespace patina::devices {

struct LightCaps {
  std::string id;
  bool confirms = false;      // isOn() is read back from the hardware
  bool incandescent = false;  // ripples at twice the mains frequency
  double mains_hz = 50;
  Nanoseconds warm_up{};  // until its level is worth measuring
};

// Thread-bound. Destruction switches the lamp off where it can (heat).
class Light {
 public:
  virtual ~Light() = default;
  virtual const LightCaps& caps() const = 0;
  virtual Result<void> set(double level) = 0;      // [0,1]; 0 = off; idempotent
  virtual Result<std::optional<bool>> isOn() = 0;  // nothing: the lamp cannot tell
  virtual Result<void> recover() = 0;              // idempotent; start-up too; leaves it off
};

}  // namespace patina::devices
