// SPDX-License-Identifier: GPL-3.0-or-later
// Decorators that misbehave by script around any camera, light or sensor, twin or real.
//
// A fault acts on calls made in [at, at + duration) of the run, or on exactly one call, the first
// at or after `at`, when its duration is zero. Same plan, seed and times: same trouble.
//   hang          collect sleeps to its deadline: kTimeout. Then every call is kTimeout until
//                 recover(kReopen or stronger) after the fault's end; the picture is gone.
//   busy          trigger: kBusy; the camera stays ready. A light's set, a sensor's read as well.
//   lost          every call kLost until recover(kReset or stronger) after the fault's end.
//   partial_file  one file cut at a seeded place; declared_bytes is the true length.
//   duplicate     the first file comes twice.
//   late          collect sleeps to its deadline: kTimeout, then recover() is needed. The picture
//                 comes before those of the next collect that works, with its own old sequence.
//   stale_frame   the previous shot's bytes under the new sequence: only their hash tells. The
//                 first shot of a camera cannot be stale.
//   wrong_size    the middle of the picture, half as wide and half as high, in the same format.
//   corrupt_bytes a block of up to 512 bytes changed, length kept.
//   sensor_silent read: kTimeout.
// hang and lost work on lights and sensors too (any recover() after the end cures them). Lamp
// faults are the twin's business, since no decorator can darken a picture; power cuts are the
// supervisor's.
#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::devices {

// How often each fault of a plan acted. Thread-safe: a rig's decorators share it; outlives them.
class FaultReport {
 public:
  explicit FaultReport(const FaultPlan& plan);
  void countFired(std::size_t index);
  std::int64_t fired(std::size_t index) const;  // calls that fault `index` of the plan spoiled
  std::vector<Fault> neverFired() const;        // lamps and power left out: they act elsewhere

 private:
  mutable std::mutex mutex_;
  std::vector<Fault> faults_;
  std::vector<std::int64_t> counts_;
};

// Each takes the faults of its own id, relative to `start`; clock and report outlive the decorator.
// One-call faults whose time is past when the decorator is made count as over (a restarted run).
std::unique_ptr<Camera> withFaults(std::unique_ptr<Camera> camera, const FaultPlan& plan,
                                   MonoTime start, Clock& clock, FaultReport* report = nullptr);
std::unique_ptr<Light> withFaults(std::unique_ptr<Light> light, const FaultPlan& plan,
                                  MonoTime start, Clock& clock, FaultReport* report = nullptr);
std::unique_ptr<Sensor> withFaults(std::unique_ptr<Sensor> sensor, const FaultPlan& plan,
                                   MonoTime start, Clock& clock, FaultReport* report = nullptr);
// Every camera, light and sensor of a rig.
Rig withFaults(Rig rig, const FaultPlan& plan, MonoTime start, Clock& clock,
               FaultReport* report = nullptr);

}  // namespace patina::devices
