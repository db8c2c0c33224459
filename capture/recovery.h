// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder a failing camera is led up: retry, drain, reopen, reset, power cycle, then down. The
// other cameras go on. A camera that is down is tried again at every step.
#pragma once

#include <string>

#include "devices/camera.h"

namespace patina::capture {

class RecoveryLadder {
 public:
  // A shot of this camera failed so. The rung to try before the next attempt; nothing is higher
  // than a power cycle, and a failure after that takes the camera down.
  void failed(const devices::Error& error);
  void takeDown() { down_ = true; }
  void succeeded();

  bool down() const { return down_; }
  bool troubled() const { return failures_ > 0; }
  devices::Rung rung() const { return rung_; }
  const std::string& lastError() const { return last_error_; }

  // The rung for a camera that is down, once a step: a reset, and every tenth time a power cycle.
  devices::Rung rungWhileDown();

 private:
  devices::Rung rung_ = devices::Rung::kRetry;
  int failures_ = 0;
  int steps_down_ = 0;
  bool down_ = false;
  std::string last_error_;
};

}  // namespace patina::capture
