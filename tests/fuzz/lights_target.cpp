// SPDX-License-Identifier: GPL-3.0-or-later
// Directions of lights (.lp).
#include "capture/workflow/lights_file.h"
#include "processing/image/failure.h"
#include "tests/fuzz/targets.h"

namespace patina::testing {

void fuzzLights(std::span<const std::byte> bytes) {
  try {
    workflow::parseLights({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, "dirs.lp");
  } catch (const Failure&) {
    // Refused, with the line.
  }
}

}  // namespace patina::testing
