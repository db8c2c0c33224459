// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/calibration_key.h"

#include <cmath>
#include <cstdio>

namespace patina::calibration {
namespace {

constexpr double kSecondsMax = 30 * 86400.0, kKelvinMax = 5;
constexpr double kExposureShare = 0.01;

std::string text(SizePx s) { return std::to_string(s.width) + "x" + std::to_string(s.height); }

std::string text(const char* format, double value) {
  char out[64];
  std::snprintf(out, sizeof out, format, value);
  return out;
}

// What of a key must agree, by kind.
struct Demands {
  bool size = true, iso = true, exposure = false, temperature = false, age = true;
};
Demands demandsOf(const std::string& kind) {
  if (kind == "dark" || kind == "dark_flat") return {.exposure = true, .temperature = true};
  if (kind == "flat") return {.temperature = true};
  if (kind == "defects") return {.iso = false};  // its currents are scaled to the frame
  if (kind == "photon_transfer") return {.size = false, .age = false};
  if (kind == "response") return {.size = false, .iso = false, .age = false};
  return {.temperature = true};
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
  if (calibration.kind == "flat" && !calibration.light_state.empty() &&
      calibration.light_state != frame.light_state)
    return "lit by " + calibration.light_state + ", not " + frame.light_state;
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
  if (demands.age && !(distance.time_s <= kSecondsMax))
    return text("%.0f days away", distance.time_s / 86400);
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
  return "take it anew for camera " + frame.device_id;
}

}  // namespace patina::calibration
