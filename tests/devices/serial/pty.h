// SPDX-License-Identifier: GPL-3.0-or-later
// The other end of a serial line: a device that answers by script, in a thread of its own.
#pragma once

#include <functional>
#include <string>
#include <thread>

#include "devices/descriptor.h"

namespace patina::testing {

class Pty {
 public:
  // What the device says to a line it hears (without its end); may be nothing.
  using Answer = std::function<std::string(const std::string&)>;
  explicit Pty(Answer answer = {});
  ~Pty();
  const std::string& path() const { return path_; }  // to open as a serial port
  void say(const std::string& bytes) const;
  void sayAndArrive(const std::string& bytes) const;  // and wait until they lie in the port
  void unplug();                                      // the port's reader meets a hang-up

 private:
  void serve();
  Answer answer_;
  devices::Descriptor master_, kept_open_, stop_read_, stop_write_;
  std::string path_;
  std::thread thread_;
};

}  // namespace patina::testing
