// SPDX-License-Identifier: GPL-3.0-or-later
// Feature reports of a HID device: the seam below hid_relay.h.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>

#include "devices/result.h"

namespace patina::devices::usb {

using FeatureReport = std::array<std::uint8_t, 8>;

// An open device. The kernel waits at most five seconds for it.
class HidWire {
 public:
  virtual ~HidWire() = default;
  virtual Result<FeatureReport> feature() = 0;
  virtual Result<void> setFeature(const FeatureReport& report) = 0;
};
using OpenHid = std::function<Result<std::unique_ptr<HidWire>>(const std::filesystem::path& node)>;

// Report number 0 of /dev/hidrawN.
Result<std::unique_ptr<HidWire>> openHidraw(const std::filesystem::path& node);

}  // namespace patina::devices::usb
