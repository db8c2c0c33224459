// SPDX-License-Identifier: GPL-3.0-or-later
// What hangs on USB, as the kernel's sysfs tells it. `root` stands in place of "/" everywhere.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "devices/result.h"

namespace patina::devices::usb {

struct UsbDevice {
  std::string name;  // "1-1.4": bus 1, port 1 of the root hub, port 4 of the hub there
  int vendor = 0, product = 0;
  int bus = 0, number = 0;  // the number changes with every replug
  std::string serial, model;
  bool is_hub = false;
  bool superspeed = false;
  bool may_suspend = false;  // the kernel puts it to sleep when idle

  std::filesystem::path node() const;  // "dev/bus/usb/001/014", below root
  std::string describe() const;        // "Canon EOS 90D serial 123 (1-1.4)"
};

std::vector<UsbDevice> attached(const std::filesystem::path& root = "/");

// 0 or "": any.
struct UsbIdentity {
  int vendor = 0, product = 0;
  std::string serial;
};
// kLost with what is attached instead; kRefused when several fit and cannot be told apart.
Result<UsbDevice> findDevice(const UsbIdentity& wanted, const std::filesystem::path& root = "/");

}  // namespace patina::devices::usb
