// SPDX-License-Identifier: GPL-3.0-or-later
// What takes a camera's power away and gives it back: the last rung of the ladder.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/light.h"
#include "devices/result.h"
#include "devices/usb/hub_port.h"

namespace patina::devices::usb {

class PowerSwitch {  // Thread-bound.
 public:
  virtual ~PowerSwitch() = default;
  virtual Result<void> cut() = 0;
  virtual Result<void> restore() = 0;  // idempotent
  // What else goes dark with it, by name. kUnsupported: there is nothing to switch.
  virtual Result<std::vector<std::string>> alsoDrops() = 0;
};

// Power off for `off`, then on, whatever happened in between; the first error.
Result<void> cyclePower(PowerSwitch& power, Nanoseconds off, Clock& clock);

// The port of a hub, both halves of it. It is looked up at each call; of a device that is gone the
// port it was last seen on counts: let alsoDrops() run once while all is well. The device's serial
// tells it from others; wire and clock outlive the switch.
std::unique_ptr<PowerSwitch> makeHubPower(UsbIdentity device, HubWire& wire, Clock& clock,
                                          std::filesystem::path root = "/");

// A relay, as a [[power]] of the rig. The camera hangs on its normally closed contact: "on" cuts,
// and a relay that fails or is let go gives power. The light outlives the switch.
std::unique_ptr<PowerSwitch> makeRelayPower(Light& relay);

}  // namespace patina::devices::usb
