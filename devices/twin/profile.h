// SPDX-License-Identifier: GPL-3.0-or-later
// The twin's physical constants. Shares are fractions of one, not percent.
#pragma once

#include <string_view>

#include "processing/image/units.h"

namespace patina::devices::twin {

struct SensorProfile {  // the image sensor; electrons unless named otherwise
  double full_well = 0, read_noise = 0;
  int bits = 0, black_level = 0;
  double dark_current = 0;  // e-/s at dark_reference
  Celsius dark_reference;
  double dark_doubling_k = 0;
  double prnu = 0;
  double hot_pixel_every = 0, hot_current_min = 0, hot_current_max = 0;
  double grey_reflectance = 0, grey_fill = 0;
  Nanoseconds grey_exposure{}, readout_512{}, readout_min{};

  int whiteLevel() const { return (1 << bits) - 1; }
  // Electrons that one step of the converter stands for, at ISO 100.
  double electronsPerStep() const { return full_well / (whiteLevel() - black_level); }
  // Dark current doubles every dark_doubling_k: multiply a current at dark_reference by this.
  double darkFactor(Celsius temperature) const;
};

struct LensProfile {
  double k1 = 0, k2 = 0;      // radial distortion, radius in focal lengths
  double focal_length = 0;    // in picture widths
  double corner_falloff = 0;  // share of light missing in the corners
};

struct LampProfile {
  double shot_to_shot = 0;  // RMS
  double warm_up = 0;       // share missing when cold
  Nanoseconds warm_up_tau{};
  double ripple = 0;  // peak to peak, share of the mean
  double mains_hz = 0;
  double illuminance_lux = 0;
};

struct ExposureProfile {
  int mains_half_periods = 0;
  Nanoseconds min{}, max{};
};

struct PatchProfile {
  int side_px = 0, small_below_px = 0, small_divisor = 1;
  double reflectance = 0, border_reflectance = 0;
};

struct RoomProfile {
  double ambient = 0;
  double temperature_c = 0, temperature_swing_c = 0, temperature_noise_c = 0;
  double humidity = 0, humidity_swing = 0, humidity_noise = 0;  // in percent
  double lux_noise = 0;
};

struct Profile {
  SensorProfile sensor;
  LensProfile lens;
  LampProfile lamp;
  ExposureProfile exposure;
  PatchProfile patch;
  RoomProfile room;
};

// The frozen reference profile (reference.toml, part of the program). Thread-safe.
const Profile& referenceProfile();
std::string_view referenceProfileText();

}  // namespace patina::devices::twin
