// SPDX-License-Identifier: GPL-3.0-or-later
// The ladder's upper rungs, which belong to the bus and the socket rather than to a camera's
// driver.
#pragma once

#include <functional>
#include <memory>

#include "devices/camera.h"

namespace patina::devices::host {

// Each is nothing where there is no such way; then the rung is kUnsupported, unless the driver
// itself has one.
struct Rungs {
  std::function<Result<void>()> reset;        // of the USB device
  std::function<Result<void>()> power_cycle;  // off, a while, on
};

// The rung is done and the driver opens the camera again, also when the rung could not be done: the
// camera may have come back by itself.
std::unique_ptr<Camera> withRungs(std::unique_ptr<Camera> camera, Rungs rungs);

}  // namespace patina::devices::host
