// SPDX-License-Identifier: GPL-3.0-or-later
// Shutter lines: cameras that are armed by their drivers and fired together by a trigger.
#pragma once

#include <string>
#include <vector>

#include "devices/rig.h"

namespace patina::capture {

class ShutterLines {
 public:
  explicit ShutterLines(devices::Rig& rig);  // borrows it

  std::vector<devices::Error> start();  // opens each line
  bool serve(const std::string& camera) const;

  struct Fired {
    std::vector<std::string> cameras;
    devices::Result<MonoTime> at;  // when the line went active
  };
  // The lines of these cameras, one after the other, each once; a line that fails is recovered and
  // tried once more.
  std::vector<Fired> fire(const std::vector<std::string>& cameras);

 private:
  struct Line {
    devices::Trigger* trigger = nullptr;
    std::vector<std::string> cameras;
  };
  std::vector<Line> lines_;
};

}  // namespace patina::capture
