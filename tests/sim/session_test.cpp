// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Each;
using ::testing::HasSubstr;

TEST(Session, CapturesEveryStepOfAQuietRun) {
  Simulation sim({});
  const auto summary = sim.run();
  EXPECT_EQ(summary.end, "finished");
  EXPECT_EQ(summary.last.captured, 12);
  EXPECT_THAT(sim.decisions(), Each(std::string("captured")));
  sim.expectWhole();
  EXPECT_EQ(sim.reader().runs().back().state, "finished");
}

TEST(Session, WritesTheSameHashForTheSameSeedAndAnotherForAnother) {
  Simulation a({}), b({}), c({.seed = 2});
  const std::string first = a.run().event_log_sha256;
  EXPECT_EQ(first.size(), 64u);
  EXPECT_EQ(b.run().event_log_sha256, first);
  EXPECT_NE(c.run().event_log_sha256, first);
}

}  // namespace
}  // namespace patina::testing
