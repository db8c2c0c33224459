// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/troubles.h"

#include <algorithm>
#include <cmath>

#include "processing/image/random.h"

namespace patina::devices::twin {

namespace {

constexpr double kTurnDegAMm = 0.2;
constexpr int kWarpSteps = 64;

struct Shove {
  double x_mm, y_mm, turned_deg;
};
Shove shoveOf(const Fault& fault, std::uint64_t seed) {
  const std::uint64_t key = hashSeed(seed, static_cast<std::uint64_t>(fault.at.count()), 0xb01dull);
  const double angle = 2 * M_PI * uniform(key);
  return {fault.amount * std::cos(angle), fault.amount * std::sin(angle),
          fault.amount * kTurnDegAMm * (2 * uniform(hashSeed(key, 1)) - 1)};
}

}  // namespace

bool isActive(const Fault& fault, Nanoseconds run_time) {
  return run_time >= fault.at && run_time - fault.at < fault.duration;
}

SpecimenPose specimenPoseAt(const FaultPlan& faults, Nanoseconds run_time, Nanoseconds process) {
  SpecimenPose pose;
  for (const Fault& fault : faults.faults) {
    if (run_time < fault.at) continue;
    if (fault.kind == FaultKind::kSpecimenBumped && isActive(fault, run_time)) {
      const Shove shove = shoveOf(fault, faults.seed);
      pose.moved_x_mm = shove.x_mm;
      pose.moved_y_mm = shove.y_mm;
      pose.turned_deg = shove.turned_deg;
    }
    if (fault.kind == FaultKind::kSpecimenWarps) {
      const Nanoseconds lasts = fault.duration < kFaultForEver
                                    ? fault.duration
                                    : std::max(process - fault.at, Nanoseconds{1});
      const double share = std::min(toSeconds(run_time - fault.at) / toSeconds(lasts), 1.0);
      pose.shrunk = fault.amount * std::floor(share * kWarpSteps) / kWarpSteps;
    }
  }
  return pose;
}

CameraPose bumpedPose(const CameraPose& pose, const FaultPlan& faults, const std::string& camera,
                      Nanoseconds run_time) {
  CameraPose bumped = pose;
  for (const Fault& fault : faults.faults) {
    if (fault.kind != FaultKind::kCameraBumped || fault.device != camera) continue;
    if (!isActive(fault, run_time)) continue;
    const Shove shove = shoveOf(fault, faults.seed);
    bumped.moved_mm = {shove.x_mm, shove.y_mm, 0};
    bumped.roll_deg = pose.roll_deg + shove.turned_deg;
  }
  return bumped;
}

LampPlace placeAt(const LampPlace& place, const FaultPlan& faults, const std::string& light,
                  Nanoseconds run_time) {
  LampPlace stands = place;
  for (const Fault& fault : faults.faults)
    if (fault.kind == FaultKind::kLightsMirrored && fault.device == light &&
        isActive(fault, run_time))
      stands.position_mm.x = -place.position_mm.x;
  return stands;
}

}  // namespace patina::devices::twin
