// SPDX-License-Identifier: GPL-3.0-or-later
// When the faults of one device are due: the part that camera, light and sensor decorators share.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/fault/faulty_devices.h"
#include "devices/fault_plan.h"

namespace patina::devices {

// A fault that acts on the present call.
struct DueFault {
  MonoTime end;            // of its time; the present, for a fault of one call
  std::uint64_t seed = 0;  // of this fault at this moment
};

class FaultScript {
 public:
  // A one-call fault whose time is past by now is left out: a run that goes on after a crash must
  // not meet yesterday's trouble again.
  FaultScript(const FaultPlan& plan, const std::string& device, MonoTime start, Clock& clock,
              FaultReport* report);

  // The first fault of `kind` that is due now; a fault of one call is used up by this. Counts it.
  std::optional<DueFault> take(FaultKind kind);
  // The same question without using anything up.
  bool isDue(FaultKind kind) const;
  bool plans(FaultKind kind) const;

  Clock& clock() const { return *clock_; }

 private:
  struct Entry {
    Fault fault;
    std::size_t index = 0;  // in the plan
    bool spent = false;
  };
  bool due(const Entry& entry, Nanoseconds since_start) const;

  std::uint64_t seed_;
  MonoTime start_;
  Clock* clock_;
  FaultReport* report_;
  std::vector<Entry> entries_;
};

// How long a call to a hung device takes to give up; within the contract's cycle + 10 s.
constexpr Nanoseconds kHungCall = std::chrono::seconds(2);

}  // namespace patina::devices
