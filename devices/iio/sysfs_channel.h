// SPDX-License-Identifier: GPL-3.0-or-later
// Channels of IIO and hwmon devices as files in sysfs.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/result.h"
#include "devices/sensor.h"

namespace patina::devices::iio {

enum class Kernel { kIio, kHwmon };
const char* name(Kernel kernel);  // as a rig file names the backend

struct Channel {
  std::filesystem::path folder;  // of the device, as it is numbered now
  std::string device;            // its name
  std::string label;             // of the channel, else of the device
  std::string place;             // on its bus: stays the same
  std::string prefix;            // "in_illuminance" "temp1": the files are prefix_raw, _input ...
  std::string describe() const;  // "tsl2591 in_illuminance (i2c-1/1-0039)"
};

// Of one quantity, in order of place and prefix.
std::vector<Channel> channels(Kernel kernel, Quantity quantity, const std::filesystem::path& root);

// In unit(quantity): what the kernel gives ready (_input), else (raw + offset) * scale. kBusy: ask
// again; kLost: the device is gone; kTimeout at the deadline, as far as the kernel lets us wait: a
// read that hangs inside of it does not come back.
Result<double> readChannel(const Channel& channel, Kernel kernel, Quantity quantity, Clock& clock,
                           MonoTime deadline);

}  // namespace patina::devices::iio
