// SPDX-License-Identifier: GPL-3.0-or-later
// The backends that the contract suites run over. A new backend is a row in backends.cpp.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::testing {

// Devices as their maker leaves them: closed. The clock outlives them.
struct RigUnderTest {
  std::unique_ptr<devices::VirtualClock> clock;
  devices::Rig rig;
};

struct Backend {
  std::string name;  // letters and digits: part of a test's name
  std::function<RigUnderTest()> make;
};

inline void PrintTo(const Backend& backend, std::ostream* out) { *out << backend.name; }

// In this process: cheap enough for thousands of shots.
std::vector<Backend> bareBackends();
// Each bare one, a hosted one, and each again in decorators whose faults lie years ahead.
std::vector<Backend> bareAndWrappedBackends();
// One rig of `backend` whose every device has the faults of `plan` that name it, from now on.
RigUnderTest makeWithFaults(const Backend& backend, const devices::FaultPlan& plan);

inline std::string backendName(const ::testing::TestParamInfo<Backend>& info) {
  return info.param.name;
}

}  // namespace patina::testing
