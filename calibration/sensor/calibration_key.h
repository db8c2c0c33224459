// SPDX-License-Identifier: GPL-3.0-or-later
// What a calibration was taken with, how far it lies from a frame, and what to shoot where none is
// near enough. Nothing is matched silently.
#pragma once

#include <string>

#include "processing/image/units.h"

namespace patina::calibration {

struct CalibrationKey {
  // "bias" "dark" "dark_flat" "flat" "defects" "photon_transfer" "response" "vignetting" "lens"
  // "view" "gain_field" "albedo" "colour" "lights" "light_gain"; of a frame: any
  std::string kind, device_id;
  Nanoseconds exposure{};
  double iso = 0;
  SizePx size;
  double temperature_c = 20;
  UtcTime utc;
  std::string light_state;  // of a flat: the lamps it was lit by, whose field it holds; empty: any
  int bits = 0;             // of a sample as stored; 0: not known, fits all
  double focal_mm = 0, focus_m = 0;  // of the lens, as files say; 0: not known, fits all
};
struct CalibrationDistance {
  bool usable =
      false;  // same camera, and size, ISO, bits, light, zoom and exposure where they matter
  std::string why_not;  // also why it is out of tolerance; empty when it is within
  double time_s = 0, temperature_k = 0;
  bool within_tolerance =
      false;  // 30 days (view, vignetting: 90), 5 K; a flat: exposure within 1 %
};
// A dark's charge grows with exposure and temperature: of another exposure it is not usable. A flat
// of another exposure is out of tolerance: shutters and lamps differ with time, so flats keep the
// run's exposure and the light is dimmed. What a lens gives (lens, view, vignetting, gain_field) is
// not usable at another focal length (1 %) or focus (5 %).
CalibrationDistance distanceBetween(const CalibrationKey& frame, const CalibrationKey& calibration);

// "shoot 16 darks at 1/50, ISO 100, within 5 K of 21 C": what would fit this frame.
std::string shootInstead(const CalibrationKey& frame, const std::string& kind);

}  // namespace patina::calibration
