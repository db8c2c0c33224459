// SPDX-License-Identifier: GPL-3.0-or-later
// The power of the port a device hangs on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/result.h"
#include "devices/usb/hub_wire.h"

namespace patina::devices::usb {

struct HubPort {
  std::string hub;  // sysfs name, "1-1" or "usb2"
  int port = 0;     // from 1
  bool operator==(const HubPort&) const = default;
};
// Of a device by its sysfs name; nothing for a root hub.
std::optional<HubPort> portOf(const std::string& device);
// The other half of a connector that has USB 2 and USB 3 pins: both must be off to cut its power.
std::optional<HubPort> companionOf(const HubPort& port, const std::filesystem::path& root = "/");

enum class PowerSwitching { kNone, kAllPorts, kEachPort };
const char* name(PowerSwitching switching);
// From a hub descriptor (USB 2.0, 11.23.2.1; USB 3.2, 10.15.2.1). kCorrupt when it is none.
Result<PowerSwitching> switchingOf(const std::vector<std::uint8_t>& hub_descriptor);
// Asks the hub itself.
Result<PowerSwitching> askSwitching(const UsbDevice& hub, HubWire& wire);

// What else loses power with `port` and its companion, by name; `keep` is the device itself.
std::vector<std::string> alsoDrops(const HubPort& port, PowerSwitching switching,
                                   const std::string& keep,
                                   const std::filesystem::path& root = "/");

// Told, then read back: kUnsupported when the hub says yes and does nothing, as many do.
Result<void> setPortPower(const HubPort& port, bool powered, HubWire& wire, Clock& clock,
                          const std::filesystem::path& root = "/");

}  // namespace patina::devices::usb
