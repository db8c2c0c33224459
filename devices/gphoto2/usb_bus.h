// SPDX-License-Identifier: GPL-3.0-or-later
// What the operating system says of a camera on USB: its node, who holds it, who may open it.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace patina::devices::gphoto2 {

// "usb:001,014" -> /dev/bus/usb/001/014; nothing for other ports.
std::optional<std::filesystem::path> usbNode(const std::string& port);

// The serial in the device's USB descriptor, as the kernel read it; empty: none, or not known.
std::string usbSerial(const std::string& port,
                      const std::filesystem::path& sysfs = "/sys/bus/usb/devices");
bool mayOpen(const std::filesystem::path& node);

struct Holder {
  int pid = 0;
  std::string name;         // of its program
  std::string how_to_stop;  // one line
};
// Processes with an open descriptor of the node, this one left out. Those of other users are only
// seen by root: known grabbers (gvfs and the like) are then told of by name alone.
std::vector<Holder> holdersOf(const std::filesystem::path& node,
                              const std::filesystem::path& proc = "/proc");
std::string describe(const std::vector<Holder>& holders);  // "gvfsd-gphoto2 (pid 812): ..."

}  // namespace patina::devices::gphoto2
