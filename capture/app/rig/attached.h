// SPDX-License-Identifier: GPL-3.0-or-later
// What is attached to this machine, by every backend at once.
#pragma once

#include <string>
#include <vector>

#include "capture/app/rig/backends.h"
#include "devices/clock.h"

namespace patina::rig {

struct Attached {
  std::vector<devices::FoundDevice> devices;  // by backend, in the table's order
  // Backends that could not look, with why: also one that hung and was killed.
  std::vector<std::pair<std::string, std::string>> failures;
};
// Each backend looks in a process of its own, all at the same time, `limit` at most. Serials that
// two devices of one model share become their trouble. `command` as of openHosted.
Attached findAll(Nanoseconds limit, const std::vector<std::string>& command = {});

// Opens each camera that the twin does not make, all at the same time, and closes it again. Throws
// Failure(kUnavailable) that names those that did not open and what is attached instead. The clock
// is a real one.
void requireCameras(const devices::RigSpec& spec, devices::Clock& clock,
                    const std::vector<std::string>& command = {});

// Two devices of one kind and model that cannot be told apart: said of both.
void markTwins(std::vector<devices::FoundDevice>& devices);

}  // namespace patina::rig
