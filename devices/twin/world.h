// SPDX-License-Identifier: GPL-3.0-or-later
// The room of the twin: one specimen, its lamps and its air, as all devices of the rig see them.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "devices/clock.h"
#include "devices/rig.h"
#include "devices/twin/lamp.h"
#include "devices/twin/lamp_field.h"
#include "devices/twin/profile.h"
#include "devices/twin/sky.h"
#include "devices/twin/specimen.h"
#include "devices/twin/specimen_pose.h"
#include "devices/twin/twin.h"

namespace patina::devices::twin {

// Thread-safe: devices may live on threads of their own. Times count from the run's start, by UTC,
// so that a process started again finds the world where it would have been.
class World {
 public:
  World(const RigSpec& spec, const TwinOptions& options, Clock& clock);

  Clock& clock() const { return clock_; }
  const Profile& profile() const { return profile_; }
  const Specimen& specimen() const { return *specimen_; }
  const RigSpec& spec() const { return spec_; }
  std::uint64_t seed() const { return options_.seed; }

  Nanoseconds duration() const { return options_.duration; }  // of the specimen's process
  Nanoseconds runTime() const { return clock_.utc() - options_.start_utc; }
  double specimenTimeAt(Nanoseconds run_time) const;  // [0,1]
  Celsius temperatureAt(Nanoseconds run_time) const;  // of the air, noiseless
  double humidityAt(Nanoseconds run_time) const;      // percent, noiseless

  std::size_t lampCount() const { return lamps_.size(); }
  // What is said to a lamp. Under a fault of kind wrong_lamp the next one hears it, and lamps obey
  // the brightest they are told: as if plugs had been moved.
  void setLamp(std::size_t lamp, double level);
  // Mean level of every lamp over an exposure, in the rig file's order.
  std::vector<double> levelsOver(Nanoseconds begin, Nanoseconds exposure);
  LampPlace lampPlace(std::size_t lamp) const;
  Sky skyAt(Nanoseconds run_time) const;
  SpecimenPose specimenPoseAt(Nanoseconds run_time) const;
  const FaultPlan& faults() const { return options_.faults; }
  Lux illuminanceAt(std::array<double, 3> position_mm, Nanoseconds run_time);

 private:
  double dayPhase(Nanoseconds run_time) const;  // 1 at 15:00 UTC, -1 at 03:00
  bool isMisled(std::size_t lamp, Nanoseconds run_time) const;
  void pass(Nanoseconds run_time);    // what is said on to the lamps, as plugs are then
  void passTo(Nanoseconds run_time);  // at every move of a plug until then

  RigSpec spec_;
  TwinOptions options_;
  Clock& clock_;
  const Profile& profile_;
  std::unique_ptr<Specimen> specimen_;
  std::mutex mutex_;  // guards lamps_, told_, passed_
  std::vector<Lamp> lamps_;
  std::vector<double> told_;
  Nanoseconds passed_{};
  std::vector<Nanoseconds> moves_;  // of plugs, in order
  std::vector<LampPlace> places_;
};

}  // namespace patina::devices::twin
