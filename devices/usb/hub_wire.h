// SPDX-License-Identifier: GPL-3.0-or-later
// Control transfers to a hub: the seam below hub_port.h.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "devices/result.h"
#include "devices/usb/usb_device.h"

namespace patina::devices::usb {

struct Setup {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0;
  std::uint16_t length = 0;  // of the answer, when type says that the device answers
};

class HubWire {
 public:
  virtual ~HubWire() = default;
  // Within two seconds.
  virtual Result<std::vector<std::uint8_t>> control(const UsbDevice& hub, const Setup& setup) = 0;
};

// By the hub's node below `root`.
std::unique_ptr<HubWire> makeUsbfsWire(std::filesystem::path root = "/");

}  // namespace patina::devices::usb
