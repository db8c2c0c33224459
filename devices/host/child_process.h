// SPDX-License-Identifier: GPL-3.0-or-later
// A driver's process: own session and HOME, no descriptors but its channel, dead when told.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/descriptor.h"
#include "devices/result.h"

namespace patina::devices::host {

class ChildProcess {
 public:
  // `command` and "--fd 3", which is `channel`. Standard output goes to standard error.
  static Result<std::unique_ptr<ChildProcess>> start(std::vector<std::string> command,
                                                     const Descriptor& channel);
  // Waits `grace` for an end of its own, then SIGKILL. Whoever closes the channel first gives the
  // process the chance to close its devices.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void kill();  // now, and wait for its end: milliseconds, unless the kernel holds it
  bool ended(Nanoseconds within = {});
  pid_t pid() const { return pid_; }

 private:
  ChildProcess(pid_t pid, std::filesystem::path home);

  pid_t pid_;
  Descriptor handle_;  // pidfd; -1: the kernel has none
  std::filesystem::path home_;
  bool reaped_ = false;
};

}  // namespace patina::devices::host
