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

// A folder for one driver, whichever process it is in: HOME, and its notes (driver_notes.h).
class DriverHome {
 public:
  static Result<std::shared_ptr<const DriverHome>> make();
  ~DriverHome();  // with all that is in it
  DriverHome(const DriverHome&) = delete;
  DriverHome& operator=(const DriverHome&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  explicit DriverHome(std::filesystem::path path) : path_(std::move(path)) {}
  std::filesystem::path path_;
};

class ChildProcess {
 public:
  // `command` and "--fd 3", which is `channel`. Standard output goes to standard error. `home`:
  // null is one for this process alone.
  static Result<std::unique_ptr<ChildProcess>> start(
      std::vector<std::string> command, const Descriptor& channel,
      std::shared_ptr<const DriverHome> home = nullptr);
  // Waits `grace` for an end of its own, then SIGKILL. Whoever closes the channel first gives the
  // process the chance to close its devices.
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  void kill();  // now, and wait for its end: milliseconds, unless the kernel holds it
  bool ended(Nanoseconds within = {});
  pid_t pid() const { return pid_; }

 private:
  ChildProcess(pid_t pid, std::shared_ptr<const DriverHome> home);

  pid_t pid_;
  Descriptor handle_;  // pidfd; -1: the kernel has none
  std::shared_ptr<const DriverHome> home_;
  bool reaped_ = false;
};

}  // namespace patina::devices::host
