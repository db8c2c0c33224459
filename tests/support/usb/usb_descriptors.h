// SPDX-License-Identifier: GPL-3.0-or-later
// What the camera says of itself as a USB device: a still image device of PTP's class.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "processing/image/picture_file.h"

namespace patina::testing {

struct UsbIdentity {
  std::uint16_t vendor = 0x1d6b, product = 0x0100;
  std::string manufacturer = "Patina", name, serial;
};

// Device and configuration descriptor, as sysfs and the node show them.
Bytes usbDescriptors(const UsbIdentity& who);
// Of GET_DESCRIPTOR for a text; nothing for any other request.
std::optional<Bytes> textDescriptor(const UsbIdentity& who, std::span<const std::byte> setup);
// What umockdev plugs in: /sys and /dev as udev would show them.
std::string usbDevice(const UsbIdentity& who, const std::string& name, int number);

}  // namespace patina::testing
