// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/light_settings.h"

namespace patina::devices {

using namespace std::chrono_literals;

LightCaps takeLightCaps(Settings& settings, const std::string& id) {
  LightCaps caps;
  caps.id = id;
  caps.incandescent = settings.takeChoice("kind", {"led", "incandescent"}) == "incandescent";
  caps.mains_hz = settings.takeNumber("mains_hz", 16, 400, 50);
  caps.warm_up = settings.takeDuration("warm_up", 0s, 24h, 0s);
  return caps;
}

Result<void> checkLevel(double level, const std::string& who) {
  if (level >= 0 && level <= 1) return {};
  return fail(Errc::kRefused, who + ": set: level is outside [0,1]");
}

}  // namespace patina::devices
