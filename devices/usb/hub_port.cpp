// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hub_port.h"

#include <cstdlib>

namespace fs = std::filesystem;

namespace patina::devices::usb {
namespace {

using namespace std::chrono_literals;

// USB 2.0, 11.24.2 and USB 3.2, 10.16.2.
constexpr std::uint8_t kGetHub = 0xa0, kGetPort = 0xa3, kSetPort = 0x23;
constexpr std::uint8_t kGetStatus = 0, kClearFeature = 1, kSetFeature = 3, kGetDescriptor = 6;
constexpr std::uint16_t kPortPower = 8;
constexpr std::uint8_t kHubDescriptor = 0x29, kSuperspeedHubDescriptor = 0x2a;
constexpr unsigned kConnected = 0x0001, kPowered2 = 0x0100, kPowered3 = 0x0200;

constexpr Nanoseconds kLookAgain = 50ms, kPatience = 2s;

Result<UsbDevice> hubNamed(const std::string& name, const fs::path& root) {
  for (UsbDevice& d : attached(root))
    if (d.name == name) return std::move(d);
  return fail(Errc::kLost, "USB hub " + name + " is not there any more");
}

bool isBelow(const std::string& device, const HubPort& port) {
  const bool root_hub = port.hub.starts_with("usb");
  const std::string own =
      (root_hub ? port.hub.substr(3) + "-" : port.hub + ".") + std::to_string(port.port);
  return device == own || device.starts_with(own + ".");
}
bool isBelowHub(const std::string& device, const std::string& hub) {
  return hub.starts_with("usb") ? device.starts_with(hub.substr(3) + "-")
                                : device.starts_with(hub + ".");
}

Result<unsigned> portStatus(const UsbDevice& hub, int port, HubWire& wire) {
  const auto status =
      wire.control(hub, {kGetPort, kGetStatus, 0, static_cast<std::uint16_t>(port), 4});
  if (!status) return tl::make_unexpected(status.error());
  if (status->size() < 2) return fail(Errc::kCorrupt, "hub " + hub.describe() + ": short status");
  return static_cast<unsigned>((*status)[0] | (*status)[1] << 8);
}

}  // namespace

std::optional<HubPort> portOf(const std::string& device) {
  const auto dash = device.find('-');
  if (dash == std::string::npos) return std::nullopt;
  const auto dot = device.rfind('.');
  if (dot == std::string::npos)
    return HubPort{"usb" + device.substr(0, dash), std::atoi(device.c_str() + dash + 1)};
  return HubPort{device.substr(0, dot), std::atoi(device.c_str() + dot + 1)};
}

std::optional<HubPort> companionOf(const HubPort& port, const fs::path& root) {
  const std::string interface =
      port.hub.starts_with("usb") ? port.hub.substr(3) + "-0:1.0" : port.hub + ":1.0";
  std::error_code error;
  const fs::path peer = fs::canonical(root / "sys/bus/usb/devices" / interface /
                                          (port.hub + "-port" + std::to_string(port.port)) / "peer",
                                      error);
  const std::string name = peer.filename();
  const auto at = name.rfind("-port");
  if (error || at == std::string::npos) return std::nullopt;
  return HubPort{name.substr(0, at), std::atoi(name.c_str() + at + 5)};
}

const char* name(PowerSwitching switching) {
  switch (switching) {
    case PowerSwitching::kNone:
      return "does not switch power";
    case PowerSwitching::kAllPorts:
      return "switches all its ports together";
    case PowerSwitching::kEachPort:
      return "switches each port";
  }
  return "unknown";
}

Result<PowerSwitching> switchingOf(const std::vector<std::uint8_t>& d) {
  if (d.size() < 5 || (d[1] != kHubDescriptor && d[1] != kSuperspeedHubDescriptor))
    return fail(Errc::kCorrupt, "no hub descriptor");
  switch (d[3] & 3) {
    case 0:
      return PowerSwitching::kAllPorts;
    case 1:
      return PowerSwitching::kEachPort;
    default:
      return PowerSwitching::kNone;
  }
}

Result<PowerSwitching> askSwitching(const UsbDevice& hub, HubWire& wire) {
  const int type = hub.superspeed ? kSuperspeedHubDescriptor : kHubDescriptor;
  const auto descriptor =
      wire.control(hub, {kGetHub, kGetDescriptor, static_cast<std::uint16_t>(type << 8), 0, 15});
  if (!descriptor) return tl::make_unexpected(descriptor.error());
  auto switching = switchingOf(*descriptor);
  if (!switching)
    return fail(Errc::kCorrupt, "hub " + hub.describe() + ": " + switching.error().what);
  return switching;
}

std::vector<std::string> alsoDrops(const HubPort& port, PowerSwitching switching,
                                   const std::string& keep, const fs::path& root) {
  std::vector<HubPort> halves{port};
  if (const auto companion = companionOf(port, root)) halves.push_back(*companion);
  std::vector<std::string> names;
  for (const UsbDevice& device : attached(root)) {
    if (device.name == keep) continue;
    for (const HubPort& half : halves) {
      const bool drops = switching == PowerSwitching::kEachPort ? isBelow(device.name, half)
                                                                : isBelowHub(device.name, half.hub);
      if (!drops) continue;
      names.push_back(device.describe());
      break;
    }
  }
  return names;
}

Result<void> setPortPower(const HubPort& port, bool powered, HubWire& wire, Clock& clock,
                          const fs::path& root) {
  const auto hub = hubNamed(port.hub, root);
  if (!hub) return tl::make_unexpected(hub.error());
  const auto index = static_cast<std::uint16_t>(port.port);
  const auto told =
      wire.control(*hub, {kSetPort, powered ? kSetFeature : kClearFeature, kPortPower, index, 0});
  if (!told) return tl::make_unexpected(told.error());
  const unsigned bit = hub->superspeed ? kPowered3 : kPowered2;
  const MonoTime deadline = clock.mono() + kPatience;
  unsigned status = 0;
  do {
    clock.sleepUntil(clock.mono() + kLookAgain, {});
    const auto now = portStatus(*hub, port.port, wire);
    if (!now) return tl::make_unexpected(now.error());
    status = *now;
    const bool has_power = (status & bit) != 0;
    if (has_power == powered && (powered || (status & kConnected) == 0)) return {};
  } while (clock.mono() < deadline);
  return fail(Errc::kUnsupported,
              "hub " + hub->describe() + ", port " + std::to_string(port.port) +
                  (powered ? ": its power does not come back"
                           : ": it takes the order, but the device stays: this hub has no switch "
                             "for that port; use one that has, or a relay"));
}

}  // namespace patina::devices::usb
