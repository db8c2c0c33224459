// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/world_rig.h"

#include <set>
#include <string>

namespace patina::devices::twin::dslr {

RigSpec worldRig(RigSpec rig) {
  static const std::set<std::string> kOfLamps = {"aim_mm", "beam_deg", "radius_mm"};
  static const std::set<std::string> kLampKinds = {"incandescent", "led"};
  for (LightSpec& light : rig.lights) {
    light.backend = "twin";
    std::erase_if(light.settings, [](const auto& setting) {
      const auto& [key, value] = setting;
      return !kOfLamps.contains(key) && !(key == "kind" && kLampKinds.contains(value));
    });
  }
  return rig;
}

}  // namespace patina::devices::twin::dslr
