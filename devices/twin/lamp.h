// SPDX-License-Identifier: GPL-3.0-or-later
// A lamp's level over time: warm-up, ripple, noise and faults. Times count from the run's start.
#pragma once

#include <cstdint>
#include <vector>

#include "devices/fault_plan.h"
#include "devices/rig.h"
#include "devices/twin/profile.h"

namespace patina::devices::twin {

// Level 1 = this lamp, warm, at full power, averaged over a mains half-period.
//
//   level = set * (1 - warm_up (1 - w)) * ripple * (1 + noise) * faults
//
// w is the filament's and housing's warmth: dw/dt = (powered - w) / tau, so a lamp that flashes
// briefly stays cold and one that is always on is warm. Ripple is the mean of
// 1 + (ripple / 2) cos(2 pi 2 mains_hz t) over the exposure: exactly 1 for whole half-periods.
// Noise is a function of seed, lamp and the exposure's begin alone.
class Lamp {
 public:
  // A lamp that is on between shots has been on since the run began, also before this process.
  Lamp(const LightSpec& spec, bool incandescent, const LampProfile& profile,
       const FaultPlan& faults, std::uint64_t seed, Nanoseconds now);

  void set(double level, Nanoseconds now);  // [0,1]
  double set() const { return set_; }
  double warmthAt(Nanoseconds now) const;
  // Mean level over [begin, begin + exposure).
  double levelOver(Nanoseconds begin, Nanoseconds exposure) const;
  // The same without noise and ripple: what a slow sensor sees at an instant.
  double steadyLevelAt(Nanoseconds now) const;

 private:
  double rippleOver(Nanoseconds begin, Nanoseconds exposure) const;
  double faultFactor(Nanoseconds begin, Nanoseconds end) const;

  LampProfile profile_;
  bool incandescent_;
  std::uint64_t seed_;
  std::vector<Fault> faults_;  // this lamp's
  double set_ = 0;
  double warmth_ = 0;  // at since_
  Nanoseconds since_{};
};

}  // namespace patina::devices::twin
