// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual DSLR for tests: a small world of two lamps, in real or virtual time.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "devices/twin/dslr/dslr.h"

namespace patina::devices::twin::dslr {

inline RigSpec dslrRig(const std::string& size) {
  return parseRig(
      "name = 'bench'\n"
      "[[camera]]\nid = 'cam0'\nbackend = 'twin'\n"
      "[[light]]\nid = 'key'\nbackend = 'twin'\nposition_mm = [0, 0, 500]\n"
      "[[light]]\nid = 'fill'\nbackend = 'twin'\nposition_mm = [300, 100, 400]\n"
      "[twin]\nspecimen = 'copper_patination'\nsize = '" +
          size + "'\n",
      "rig.toml");
}

// A world that began when the clock says it is now.
inline std::shared_ptr<World> dslrWorld(Clock& clock, const std::string& size = "64x48") {
  TwinOptions options;
  options.start_utc = clock.utc();
  return std::make_shared<World>(dslrRig(size), options, clock);
}

}  // namespace patina::devices::twin::dslr
