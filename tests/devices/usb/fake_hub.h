// SPDX-License-Identifier: GPL-3.0-or-later
// Hubs that answer control transfers, honest ones and others.
#pragma once

#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "devices/usb/hub_wire.h"

namespace patina::testing {

class FakeHubs final : public devices::usb::HubWire {
 public:
  devices::Result<std::vector<std::uint8_t>> control(const devices::usb::UsbDevice& hub,
                                                     const devices::usb::Setup& setup) override {
    if (silent) return devices::fail(devices::Errc::kTimeout, "fake: silent");
    if (setup.request == 6) {
      const std::uint8_t type = hub.superspeed ? 0x2a : 0x29;
      if (setup.value != type << 8) return devices::fail(devices::Errc::kRefused, "fake: type");
      return std::vector<std::uint8_t>{9, type, 4, characteristics, 0, 50, 0, 0, 0xff};
    }
    const std::pair<std::string, int> port{hub.name, setup.index};
    if (setup.request == 0) {
      const bool powered = !off.contains(port);
      unsigned status = powered ? (hub.superspeed ? 0x0200u : 0x0100u) : 0;
      if (powered || pretends) status |= 1;
      return std::vector<std::uint8_t>{static_cast<std::uint8_t>(status),
                                       static_cast<std::uint8_t>(status >> 8), 0, 0};
    }
    did.push_back(hub.name + " port " + std::to_string(setup.index) +
                  (setup.request == 3 ? " on" : " off"));
    if (setup.request == 3 && !dead) off.erase(port);
    if (setup.request == 1) off.insert(port);
    return std::vector<std::uint8_t>{};
  }

  std::uint8_t characteristics = 1;  // each port by itself
  bool silent = false;
  bool pretends = false;  // takes the order, leaves the power on
  bool dead = false;      // never gives power back
  std::set<std::pair<std::string, int>> off;
  std::vector<std::string> did;
};

}  // namespace patina::testing
