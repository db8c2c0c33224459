// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "devices/clock.h"
#include "devices/result.h"
#include "devices/usb/usb_device.h"

namespace patina::devices::usb {

// USBDEVFS_RESET: as if the device was unplugged and plugged in again, its port powered all the
// while. The kernel may take arbitrarily long over a wedged device: it is asked from a process that
// is left behind at the deadline (kTimeout). The device may come back under another number.
Result<void> resetDevice(const UsbDevice& device, Clock& clock, MonoTime deadline,
                         const std::filesystem::path& root = "/");

}  // namespace patina::devices::usb
