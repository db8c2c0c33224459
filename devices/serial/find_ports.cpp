// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include "devices/serial/serial.h"
#include "devices/serial/termios_port.h"

namespace fs = std::filesystem;

namespace patina::devices::serial {

std::vector<FoundDevice> find(const fs::path& root) {
  std::vector<FoundDevice> found;
  for (const fs::path& name : stableNames(root)) {
    FoundDevice device;
    device.kind = "port";
    device.backend = "serial";
    device.model = name.filename().string();
    device.serial = "/" + name.lexically_relative(root).string();
    std::error_code error;
    const fs::path node = fs::canonical(name, error);
    device.address =
        error ? "" : "/" + node.lexically_relative(fs::canonical(root, error)).string();
    device.state = "ready";
    if (access(name.c_str(), R_OK | W_OK) != 0) {
      device.state = "no permission";
      device.troubles.push_back({true, device.serial + " cannot be opened",
                                 "install packaging/udev/70-patina.rules and add this user to the "
                                 "group patina, then log in again"});
    }
    found.push_back(std::move(device));
  }
  return found;
}

}  // namespace patina::devices::serial
