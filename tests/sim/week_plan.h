// SPDX-License-Identifier: GPL-3.0-or-later
// What a seed makes of a week: a rig, a plan and everything that goes wrong, all over before the
// calm in which the rig has to be itself again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "processing/image/units.h"

namespace patina::testing {

// A stream of choices.
class Draw {
 public:
  explicit Draw(std::uint64_t seed) : seed_(seed) {}
  std::uint64_t below(std::uint64_t n);
  bool chance(int percent) { return below(100) < static_cast<std::uint64_t>(percent); }
  template <class T>
  const T& of(const std::vector<T>& choices) {
    return choices[below(choices.size())];
  }

 private:
  std::uint64_t seed_, drawn_ = 0;
};

// What happens to machine and disk; devices have their own faults (faults_toml).
enum class Mishap {
  kKill,       // within the next 60 calls of the disk
  kPowerCut,   // the same, and what was not synced is gone
  kUnplugged,  // the disk, for a while
  kFull,       // the disk, for a while
  kOneError,   // EIO once
  kClockStep,  // of wall time, by `length`, which may be negative
  kSuspend     // for `length`
};

struct Trouble {
  Nanoseconds at{}, length{};
  Mishap what = Mishap::kKill;
  std::uint64_t seed = 0;
};

// One picture that a step owes, as the plan's author understands it.
struct Owed {
  std::string camera, light_state;
  Nanoseconds exposure{};
  auto operator<=>(const Owed&) const = default;
};

struct WeekPlan {
  std::uint64_t seed = 1;
  std::string rig_toml, plan_toml, faults_toml;
  Nanoseconds interval{};
  std::int64_t steps = 0;
  struct Window {
    int from_min = 0, to_min = 0;  // of the local day
  };
  std::vector<Window> windows;
  int utc_offset_min = 0;
  std::vector<std::string> cameras, lights;
  std::vector<Owed> owed;
  int files_a_shot = 1;
  std::vector<Trouble> troubles;  // in order of time
  bool reboots = false;           // a machine that went down comes back with another boot
  bool power_cuts = false;
  Nanoseconds healed{};  // nothing is wrong from here on
  int waiting = 0;       // ... but for faults of one call that a closed window keeps waiting

  bool isDue(UtcTime t0, std::int64_t slot) const;
  std::string describe() const;  // for whoever looks into a failure
};

WeekPlan drawWeek(std::uint64_t seed);

}  // namespace patina::testing
