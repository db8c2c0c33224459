// SPDX-License-Identifier: GPL-3.0-or-later
// A plan on a virtual DSLR through libgphoto2, its driver in a process of its own, while the camera
// does everything wrong it can, at random: what a test needs for it, over whichever cable.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "capture/session.h"
#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/support/temp_folder.h"
#include "tests/system/driver_watch.h"
#include "tests/system/dslr_oracle.h"
#include "tests/system/dslr_wiring.h"
#include "tests/system/timed_camera.h"

namespace patina::testing {

int numberFrom(const char* variable, int fallback);  // of the environment

class DslrCampaign : public ::testing::TestWithParam<int> {
 protected:
  DslrCampaign() { takeAnotherBody(); }

  static constexpr int kShotsAStep = 4;  // two lamps, two exposures

  // One run. The USB bus is there under umockdev-wrapper alone.
  capture::SessionSummary run(const DslrWiring& wiring, int shots, int interval_ms);
  // PATINA_DSLR_SHOTS shots (50) in parts, each wired and set as the seed PATINA_DSLR_SEED (1) +
  // the parameter says.
  void misbehaveThroughout(bool usb);
  DslrVerdict verdict();      // of what this body took
  std::string story() const;  // "steps: 12 captured 3 failed; rungs: 9 reopen"

  void takeAnotherBody();  // of the same serial, with an empty card

  TempFolder folder_ = TempFolder::inMemory();
  devices::RealClock clock_;
  std::shared_ptr<devices::twin::World> world_ = devices::twin::dslr::dslrWorld(clock_);
  std::unique_ptr<devices::twin::dslr::Dslr> camera_;
  std::shared_ptr<CallTimes> times_ = std::make_shared<CallTimes>();
  DriverWatch drivers_;
  std::size_t thumbnails_ = 0;  // made of acknowledged frames by their drivers' processes
  std::vector<std::string> run_ids_;
  std::size_t first_run_ = 0;  // of this body

 private:
  devices::RigSpec rigOf(const DslrWiring& wiring, const std::string& host) const;
  devices::Rig makeRig(const devices::RigSpec& spec, Nanoseconds call_limit);
  capture::Plan planOf(int shots, int interval_ms) const;
};

}  // namespace patina::testing
