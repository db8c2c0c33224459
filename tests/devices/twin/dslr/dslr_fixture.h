// SPDX-License-Identifier: GPL-3.0-or-later
// A virtual DSLR in virtual time, with a session.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/devices/twin/dslr/dslr_bench.h"
#include "tests/devices/twin/dslr/dslr_client.h"

namespace patina::devices::twin::dslr {

class DslrTest : public ::testing::Test {
 protected:
  Answer trigger() { return client_.ask(Operation::kInitiateCapture, {0, 0}).answer; }
  std::vector<PtpEvent> shoot(Nanoseconds wait = std::chrono::seconds(1)) {
    EXPECT_EQ(trigger(), Answer::kOk);
    clock_.advance(wait);
    return camera_.takeEvents();
  }
  static int count(const std::vector<PtpEvent>& events, EventCode code) {
    return static_cast<int>(std::ranges::count(events, code, &PtpEvent::code));
  }

  VirtualClock clock_{parseUtc("2024-05-01T12:00:00.123Z")};
  std::shared_ptr<World> world_ = dslrWorld(clock_);
  Dslr camera_{world_, {.serial = "1001", .clock_off = std::chrono::seconds(90)}};
  DslrClient client_{camera_};
};

}  // namespace patina::devices::twin::dslr
