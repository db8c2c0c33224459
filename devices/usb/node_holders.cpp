// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/node_holders.h"

#include <unistd.h>

#include <algorithm>
#include <fstream>

namespace fs = std::filesystem;

namespace patina::devices::usb {
namespace {

bool holds(const fs::path& process, const fs::path& node) {
  std::error_code error;
  for (fs::directory_iterator fd(process / "fd", error), end; !error && fd != end;
       fd.increment(error)) {
    std::error_code unreadable;
    if (fs::read_symlink(fd->path(), unreadable) == node) return true;
  }
  return false;
}

}  // namespace

std::vector<Holder> holdersOf(const fs::path& node, const fs::path& proc) {
  std::vector<Holder> holders;
  std::error_code error;
  for (fs::directory_iterator it(proc, error), end; !error && it != end; it.increment(error)) {
    const std::string name = it->path().filename();
    if (name.find_first_not_of("0123456789") != std::string::npos) continue;
    const pid_t pid = static_cast<pid_t>(std::stol(name));
    if (pid == getpid() || !holds(it->path(), node)) continue;
    Holder holder{pid, ""};
    std::ifstream comm(it->path() / "comm");
    std::getline(comm, holder.command);
    holders.push_back(std::move(holder));
  }
  std::ranges::sort(holders, {}, &Holder::pid);
  return holders;
}

}  // namespace patina::devices::usb
