// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of the twin's sensor and what light it saw: truth for calibrations of the sensor.
#pragma once

#include <string>

#include "devices/twin/picture_maker.h"
#include "tests/devices/twin/bench_rig.h"

namespace patina::testing {

// One camera over one specimen, lamps key (0) and fill (1), an hour after the run began.
struct TwinStudio {
  devices::VirtualClock clock{UtcTime{}};
  devices::twin::World world;
  devices::twin::PictureMaker maker;

  TwinStudio(const std::string& specimen, const std::string& size)
      : TwinStudio(devices::twin::benchRig(specimen, size)) {}
  explicit TwinStudio(const devices::RigSpec& spec)
      : world(spec, {}, clock), maker(world, spec.cameras[0], {}, 1) {}

  static devices::twin::ShotLight shot(double key, double fill, double exposure_s,
                                       std::uint64_t noise_key, double iso = 100,
                                       double celsius = 20) {
    devices::twin::ShotLight s;
    s.begin = std::chrono::hours(1);
    s.exposure = devices::twin::defaultExposure();
    s.exposure.time = fromSeconds(exposure_s);
    s.exposure.iso = Iso{iso};
    s.levels = {key, fill};
    s.temperature = Celsius{celsius};
    s.noise_key = noise_key;
    return s;
  }
};

}  // namespace patina::testing
