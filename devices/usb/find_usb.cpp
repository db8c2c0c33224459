// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hid_relay.h"
#include "devices/usb/hub_port.h"
#include "devices/usb/usb.h"

namespace patina::devices::usb {
namespace {

FoundDevice boardAt(const std::filesystem::path& node, const UsbPlaces& places) {
  FoundDevice found;
  found.kind = "light";
  found.backend = "usb";
  found.model = "HID relay board";
  found.address = "/" + node.lexically_relative(places.root).string();
  auto wire = places.open_hid(node);
  const auto report =
      wire ? (*wire)->feature() : Result<FeatureReport>(tl::make_unexpected(wire.error()));
  const auto state =
      report ? decodeRelays(*report) : Result<RelayState>(tl::make_unexpected(report.error()));
  if (!state) {
    found.state = "does not answer";
    found.troubles.push_back({true, state.error().what,
                              "install packaging/udev/70-patina.rules, be of the group patina, "
                              "plug the board in again"});
    return found;
  }
  found.serial = state->serial;
  found.state = "ready";
  std::string closed;
  for (int relay = 1; relay <= kRelaysMax; ++relay)
    if ((state->relays >> (relay - 1)) & 1u)
      closed += (closed.empty() ? "" : " ") + std::to_string(relay);
  found.facts.emplace_back("relays on", closed.empty() ? "none" : closed);
  return found;
}

FoundDevice hubAt(const UsbDevice& hub, HubWire& wire) {
  FoundDevice found;
  found.kind = "hub";
  found.backend = "usb";
  found.model = hub.model;
  found.serial = hub.serial;
  found.address = hub.name;
  const auto switching = askSwitching(hub, wire);
  found.state = switching ? "ready" : "does not answer";
  found.facts.emplace_back("power", switching ? name(*switching) : switching.error().what);
  return found;
}

}  // namespace

std::vector<FoundDevice> find(const UsbPlaces& places) {
  std::vector<FoundDevice> found;
  for (const auto& node : relayNodes(places.root)) found.push_back(boardAt(node, places));
  const auto wire = makeUsbfsWire(places.root);
  for (const UsbDevice& device : attached(places.root))
    if (device.is_hub) found.push_back(hubAt(device, *wire));
  return found;
}

}  // namespace patina::devices::usb
