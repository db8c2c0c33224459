// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace patina::devices::usb {

struct Holder {
  pid_t pid = 0;
  std::string command;  // "gvfsd-gphoto2"
};
// Other processes that have `node` open, as far as this user may look. `node` is an absolute path,
// `proc` stands in place of "/proc".
std::vector<Holder> holdersOf(const std::filesystem::path& node,
                              const std::filesystem::path& proc = "/proc");

}  // namespace patina::devices::usb
