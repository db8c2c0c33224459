// SPDX-License-Identifier: GPL-3.0-or-later
// What the library says of an attached camera, for people. Pure.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "devices/found.h"
#include "devices/libcamera/pixel_format.h"

namespace patina::devices::libcamera {

struct AttachedCamera {
  std::string id, model, library;  // library: its version
  std::string state;               // "ready", "busy", or why not
  std::vector<std::pair<std::string, std::vector<OfferedFormat>>> streams{};  // "processed", "raw"
  std::vector<std::pair<std::string, std::string>> controls{};  // "analogue gain", "1 to 16"
  bool has_exposure = false;
};

FoundDevice describe(const AttachedCamera& camera);
FoundDevice libraryThatDoesNotStart(const std::string& why);

}  // namespace patina::devices::libcamera
