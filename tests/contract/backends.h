// SPDX-License-Identifier: GPL-3.0-or-later
// The backends that the contract suites run over. A new backend is a row in backends.cpp.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "devices/clock.h"
#include "devices/fault_plan.h"
#include "devices/rig.h"

namespace patina::testing {

// Devices as their maker leaves them: closed. Clock and world outlive them.
struct RigUnderTest {
  RigUnderTest() = default;
  RigUnderTest(std::unique_ptr<devices::VirtualClock> with_clock, devices::Rig with_rig)
      : clock(std::move(with_clock)), rig(std::move(with_rig)) {}

  std::unique_ptr<devices::VirtualClock> clock;
  std::unique_ptr<devices::Clock> real;  // instead, of what lives in real time
  std::shared_ptr<void> world;           // what is below the devices: a simulated driver, a server
  devices::Rig rig;
  // A camera that streams or waits: so long after the trigger may the light of its picture begin.
  Nanoseconds lag{};
  Nanoseconds jitter{};  // so far may `real` move by itself between two lines of a test
};

struct Backend {
  std::string name;  // letters and digits: part of a test's name
  std::function<RigUnderTest()> make;
};

inline void PrintTo(const Backend& backend, std::ostream* out) { *out << backend.name; }

// In this process: cheap enough for thousands of shots.
std::vector<Backend> bareBackends();
// Lamps, triggers and sensors of real drivers, each on a simulated other end; no cameras.
std::vector<Backend> lineBackends();
// Those of them that have such devices: lineBackendsWith(&Rig::lights).
template <class Devices>
std::vector<Backend> lineBackendsWith(Devices devices::Rig::*kind) {
  std::vector<Backend> those;
  for (Backend& backend : lineBackends())
    if (!(backend.make().rig.*kind).empty()) those.push_back(std::move(backend));
  return those;
}
// Each bare one, also in decorators whose faults lie years ahead; a hosted one, one of libcamera, a
// network camera and, under umockdev-wrapper as CTest starts the suite, one of V4L2.
std::vector<Backend> bareAndWrappedBackends();
// In real time, and not fit for decorators that step a virtual one: a virtual DSLR through
// libgphoto2, over PTP/IP.
std::vector<Backend> realTimeBackends();
// One rig of `backend` whose every device has the faults of `plan` that name it, from now on.
RigUnderTest makeWithFaults(const Backend& backend, const devices::FaultPlan& plan);

inline std::string backendName(const ::testing::TestParamInfo<Backend>& info) {
  return info.param.name;
}

}  // namespace patina::testing
