// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/calibration_key.h"

#include <cmath>
#include <cstdio>
#include <limits>

namespace patina::calibration {
namespace {

constexpr double kSecondsADay = 86400, kKelvinMax = 5;
constexpr double kExposureShare = 0.01, kFocalShare = 0.01, kFocusShare = 0.05;
constexpr double kForever = std::numeric_limits<double>::infinity();

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

// What of a key must agree, by kind.
struct Demands {
  bool size = true, iso = true, exposure = false, temperature = false, light = false, zoom = false;
  double days_most = 30;
};
Demands demandsOf(const std::string& kind) {
  if (kind == "dark" || kind == "dark_flat") return {.exposure = true, .temperature = true};
  if (kind == "flat") return {.temperature = true, .light = true};
  if (kind == "defects") return {.iso = false};  // its currents are scaled to the frame
  if (kind == "photon_transfer") return {.size = false, .days_most = kForever};
  if (kind == "response") return {.size = false, .iso = false, .days_most = kForever};
  if (kind == "lens") return {.iso = false, .zoom = true, .days_most = kForever};
  if (kind == "view" || kind == "vignetting") return {.iso = false, .zoom = true, .days_most = 90};
  if (kind == "gain_field") return {.iso = false, .light = true, .zoom = true};
  if (kind == "light_gain") return {.iso = false, .light = true};
  // Scaled by exposure and ISO where they are used.
  if (kind == "albedo" || kind == "colour") return {.size = false, .iso = false, .light = true};
  if (kind == "lights") return {.size = false, .iso = false, .days_most = 90};
  return {.temperature = true};
}

bool differ(double a, double b, double share) {
  return a > 0 && b > 0 && std::abs(a - b) > share * b;
}

bool sameExposure(Nanoseconds a, Nanoseconds b) {
  return std::abs(toSeconds(a) - toSeconds(b)) <= kExposureShare * toSeconds(b);
}

std::string whyNotUsable(const CalibrationKey& frame, const CalibrationKey& calibration) {
  const Demands demands = demandsOf(calibration.kind);
  if (frame.device_id != calibration.device_id)
    return "of camera " + calibration.device_id + ", not " + frame.device_id;
  if (demands.size && frame.size != calibration.size)
    return "of size " + text(calibration.size) + ", not " + text(frame.size);
  if (demands.iso && frame.iso != calibration.iso)
    return text("at ISO %g", calibration.iso) + text(", not %g", frame.iso);
  if (frame.bits != 0 && calibration.bits != 0 && frame.bits != calibration.bits)
    return "of " + std::to_string(calibration.bits) + " bits, not " + std::to_string(frame.bits);
  if (demands.exposure && !sameExposure(calibration.exposure, frame.exposure))
    return "exposed for " + formatExposure(calibration.exposure) + ", not " +
           formatExposure(frame.exposure);
  if (demands.light && !calibration.light_state.empty() &&
      calibration.light_state != frame.light_state)
    return "lit by " + calibration.light_state + ", not " + frame.light_state;
  if (demands.zoom && differ(calibration.focal_mm, frame.focal_mm, kFocalShare))
    return text("at %.3g mm", calibration.focal_mm) + text(", not %.3g mm", frame.focal_mm);
  if (demands.zoom && differ(calibration.focus_m, frame.focus_m, kFocusShare))
    return text("focused at %.3g m", calibration.focus_m) + text(", not %.3g m", frame.focus_m);
  return {};
}

std::string whyOutOfTolerance(const CalibrationKey& frame, const CalibrationKey& calibration,
                              const CalibrationDistance& distance) {
  const Demands demands = demandsOf(calibration.kind);
  if (calibration.kind == "flat" && calibration.exposure > Nanoseconds{} &&
      !sameExposure(calibration.exposure, frame.exposure))
    return "exposed for " + formatExposure(calibration.exposure) + ", not " +
           formatExposure(frame.exposure);
  if (demands.temperature && !(distance.temperature_k <= kKelvinMax))
    return text("%.1f K away", distance.temperature_k);
  if (!(distance.time_s <= demands.days_most * kSecondsADay))
    return text("%.0f days away", distance.time_s / kSecondsADay) +
           text(", at most %.0f", demands.days_most);
  return {};
}

}  // namespace

CalibrationDistance distanceBetween(const CalibrationKey& frame,
                                    const CalibrationKey& calibration) {
  CalibrationDistance d;
  d.time_s = std::abs(toSeconds(frame.utc - calibration.utc));
  d.temperature_k = std::abs(frame.temperature_c - calibration.temperature_c);
  d.why_not = whyNotUsable(frame, calibration);
  d.usable = d.why_not.empty();
  if (!d.usable) return d;
  d.why_not = whyOutOfTolerance(frame, calibration, d);
  d.within_tolerance = d.why_not.empty();
  return d;
}

std::string shootInstead(const CalibrationKey& frame, const std::string& kind) {
  const std::string at = " at " + formatExposure(frame.exposure) + text(", ISO %g", frame.iso),
                    near = text(", within 5 K of %.0f C", frame.temperature_c);
  if (kind == "dark") return "shoot 16 darks" + at + near;
  if (kind == "bias")
    return "shoot 16 biases at the shortest exposure" + text(", ISO %g", frame.iso);
  if (kind == "dark_flat") return "shoot 16 darks of the flats" + at + near;
  if (kind == "flat") {
    const std::string lit = frame.light_state.empty() ? "" : ", lit by " + frame.light_state;
    return "shoot 16 flats" + at + lit + ": keep the exposure and dim the light";
  }
  if (kind == "photon_transfer")
    return "shoot pairs of flats from nearly dark to nearly white and a pair of darks" +
           text(", ISO %g", frame.iso);
  if (kind == "response") return "shoot brackets of a still scene: five exposures, a stop apart";
  if (kind == "vignetting")
    return "shoot an even surface at the run's zoom and focus, and run `patina calibrate "
           "vignetting`";
  if (kind == "lens")
    return "shoot a board at the run's zoom and focus, and run `patina calibrate lens`";
  if (kind == "view") return "shoot a board lying on the specimen, and run `patina calibrate view`";
  if (kind == "gain_field")
    return "shoot a white card under " + frame.light_state +
           " alone, and run `patina calibrate "
           "field`";
  if (kind == "albedo")
    return "shoot targets of known reflectance under " + frame.light_state +
           ", and run `patina calibrate albedo`";
  return "take it anew for camera " + frame.device_id;
}

}  // namespace patina::calibration
