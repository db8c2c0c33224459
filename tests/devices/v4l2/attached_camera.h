// SPDX-License-Identifier: GPL-3.0-or-later
// What tests of this folder share: a simulated camera in virtual time and the driver above it.
#pragma once

#include <gmock/gmock.h>

#include <memory>

#include "devices/v4l2/v4l2_camera.h"
#include "tests/support/matchers.h"
#include "tests/support/v4l2/v4l2_testbed.h"

namespace patina::testing {

// Skips without umockdev, which has taken the place of /dev and /sys.
class V4l2Fixture : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!underUmockdev()) GTEST_SKIP() << "run by umockdev-wrapper (package umockdev)";
    testbed_ = std::make_unique<V4l2Testbed>();
  }

  static devices::CameraSpec spec(std::map<std::string, std::string> settings = {}) {
    devices::CameraSpec camera;
    camera.id = "cam0";
    camera.backend = "v4l2";
    camera.serial = "SIM0001";
    camera.settings = std::move(settings);
    return camera;
  }
  std::unique_ptr<devices::v4l2::V4l2Camera> make(
      std::map<std::string, std::string> settings = {}) {
    return make(spec(std::move(settings)));
  }
  std::unique_ptr<devices::v4l2::V4l2Camera> make(const devices::CameraSpec& camera) {
    return std::make_unique<devices::v4l2::V4l2Camera>(camera, "rig.toml", clock,
                                                       [this] { return slept; });
  }
  MonoTime soon(Nanoseconds in = std::chrono::seconds(5)) { return clock.mono() + in; }
  // One shot; an error of either call.
  devices::Result<devices::RawFrame> shoot(devices::Camera& camera) {
    ++sequence_;
    const auto ticket = camera.trigger({"shot/" + std::to_string(sequence_), sequence_});
    if (!ticket) return tl::make_unexpected(ticket.error());
    triggered = ticket->began_mono;
    auto frames = camera.collect(*ticket, soon());
    if (!frames) return tl::make_unexpected(frames.error());
    return frames->at(0);
  }
  V4l2Testbed& testbed() { return *testbed_; }

  devices::VirtualClock clock{utcFromNs(1'714'564'800'000'000'000)};
  Nanoseconds slept{};  // how far the clock is ahead of the kernel's stamps
  SimulatedCamera webcam{clock};
  MonoTime triggered;

 private:
  std::unique_ptr<V4l2Testbed> testbed_;
  std::uint64_t sequence_ = 0;
};

}  // namespace patina::testing
