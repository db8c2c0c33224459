// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/session.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

TEST(StartRun, RefusesAPlanThatWasEditedWhileItsRunIsUnfinished) {
  Simulation sim({});
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 33min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  const std::string first = sim.run_id;
  sim.plan = capture::parsePlan(sim.plan.toml + "band = 0.05\n", sim.plan.source);
  try {
    sim.run();
    FAIL() << "accepted";
  } catch (const capture::CaptureError& error) {
    EXPECT_THAT(error.what(), HasSubstr(first));
    EXPECT_THAT(error.what(), HasSubstr("--new-run"));
  }
  sim.session_options.new_run = true;
  EXPECT_EQ(sim.run().end, "finished");
  EXPECT_NE(sim.run_id, first);
  EXPECT_EQ(sim.reader().runs().front().state, "aborted");
}

TEST(StartRun, WhatSpeaksAgainstANewRunChangesNothingAndIsNotAskedOfOneThatGoesOn) {
  Simulation sim({});
  sim.session_options.before_new = [] {
    throw capture::CaptureError(Exit::kUnavailable, "no camera");
  };
  EXPECT_THROW(sim.run(), capture::CaptureError);
  EXPECT_TRUE(sim.reader().runs().empty());
  sim.session_options.before_new = {};
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 33min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  sim.session_options.before_new = [] {
    throw capture::CaptureError(Exit::kUnavailable, "no camera");
  };
  sim.session_options.new_run = true;
  EXPECT_THROW(sim.run(), capture::CaptureError);
  EXPECT_EQ(sim.reader().runs().back().state, "stopped");
  sim.session_options.new_run = false;
  EXPECT_EQ(sim.run().end, "finished");
}

TEST(StartRun, NamesARunByItsStartAndItsSpecimenAndNeverTwice) {
  Simulation sim({.duration = "10min"});
  sim.session_options.t0_utc = parseUtc("2024-05-01T12:00:00Z");
  sim.run();
  EXPECT_EQ(sim.run_id, "20240501T120000Z-card");
  sim.run();
  EXPECT_EQ(sim.run_id, "20240501T120000Z-card-2");
  EXPECT_EQ(sim.reader().runs().back().rig, "bench");
}

TEST(StartRun, WaitsForThePlansStartWhenItLiesAhead) {
  Simulation sim({.duration = "10min", .plan = "start = \"2024-05-02T08:00:00Z\""});
  sim.run();
  EXPECT_EQ(sim.t0, parseUtc("2024-05-02T08:00:00Z"));
  EXPECT_LT(sim.reader().newestFrame(sim.run_id)->utc - sim.t0, 1s);
}

TEST(StartRun, BeginsNowWhenThePlansStartHasPassed) {
  Simulation sim({.duration = "10min", .plan = "start = \"2024-04-01\""});
  sim.run();
  EXPECT_EQ(sim.t0, parseUtc("2024-05-01T12:00:00Z"));
  EXPECT_EQ(sim.decisions(), std::vector<std::string>{"captured"});
}

TEST(StartRun, LeavesTheUnfinishedRunOfAnotherSpecimenAlone) {
  Simulation sim({});
  std::stop_source stop;
  stop.request_stop();
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  sim.plan.specimen = "leaf";
  sim.plan.sha256 = "another";
  EXPECT_EQ(sim.run().end, "finished");
  EXPECT_EQ(sim.reader().runs().front().state, "stopped");
}

}  // namespace
}  // namespace patina::testing
