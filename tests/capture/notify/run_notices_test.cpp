// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/notify/run_notices.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/capture/notify/fake_notifier.h"
#include "tests/capture/notify/messages.h"
#include "tests/sim/simulation.h"

namespace patina::capture::notify {
namespace {

using namespace std::chrono_literals;
using patina::testing::Simulation;
using ::testing::AllOf;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;

class Notices : public ::testing::Test {
 protected:
  // Runs `sim` with everything delivered at once, and returns what was told besides states.
  std::vector<std::string> tell(Simulation& sim) {
    Dispatcher dispatcher(sim.clock);
    RunNotices notices(dispatcher, sim.clock, sim.plan, sim.rig_spec, {"run", sim.clock.utc()},
                       channelsInto({box}));
    const auto summary = sim.run([&](SessionHooks& hooks) {
      hooks.on_alive = [&] { dispatcher.work(); };
      notices.hookInto(hooks);
    });
    notices.ended(summary);
    notices.close();
    std::vector<std::string> told;
    for (const std::string& text : box->texts())
      if (!text.starts_with("step ") && text != "frame") told.push_back(text);
    return told;
  }
  std::vector<RunState> states() const {
    std::vector<RunState> states;
    for (const Message& m : box->delivered)
      if (m.kind == MessageKind::kStatus) states.push_back(m.state);
    return states;
  }
  std::shared_ptr<Box> box = std::make_shared<Box>();
};

TEST_F(Notices, TellOfAQuietRunOnlyItsBeginningAndEnd) {
  Simulation sim({});
  EXPECT_THAT(tell(sim),
              ElementsAre("the run begins", "the run finished: 12 of 12 steps captured"));
  EXPECT_EQ(states().back().state, "finished");
}

TEST_F(Notices, TellOfACameraThatHangsAndOfItsReturn) {
  Simulation sim({.duration = "6h",
                  .cameras = 2,
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"cam1\"\nkind = \"hang\"\n"
                            "duration = \"60min\"\n"});
  const auto told = tell(sim);
  EXPECT_EQ(std::count(told.begin(), told.end(), "begins camera_down"), 1);
  EXPECT_EQ(std::count(told.begin(), told.end(), "over camera_down"), 1);
  EXPECT_THAT(told, Not(Contains("begins no_frames")));  // cam0 goes on
  bool was_down = false;
  for (const RunState& state : states()) was_down = was_down || state.cameras.at("cam1") == "down";
  EXPECT_TRUE(was_down);
  EXPECT_EQ(states().back().cameras.at("cam1"), "ok");
}

TEST_F(Notices, TellOfADeadLampAndThatFramesStop) {
  Simulation sim({.duration = "6h",
                  .faults = "[[fault]]\nat = \"75min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"
                            "duration = \"60min\"\n"});
  const auto told = tell(sim);
  for (const char* expected :
       {"begins lamp_dead", "begins no_frames", "over no_frames", "over lamp_dead"})
    EXPECT_EQ(std::count(told.begin(), told.end(), expected), 1) << expected;
  EXPECT_THAT(told, Not(Contains("begins light_held")));
  bool was_dead = false;
  for (const RunState& state : states()) was_dead = was_dead || state.lights.at("key") == "dead";
  EXPECT_TRUE(was_dead);
}

TEST_F(Notices, TellOfAStepOfTheClock) {
  Simulation sim({});
  sim.clock.at(sim.clock.mono() + 35min, [&] { sim.clock.stepUtc(3h); });
  EXPECT_THAT(tell(sim), Contains("begins clock_step"));
}

TEST_F(Notices, AreCriticalWhenTheArchiveFailsAndNameTheReason) {
  Simulation sim({});
  Dispatcher dispatcher(sim.clock);
  {
    RunNotices notices(dispatcher, sim.clock, sim.plan, sim.rig_spec, {"run", sim.clock.utc()},
                       channelsInto({box}));
    notices.failed(Failure(Exit::kIo, "journal: fsync: Input/output error"));
  }
  EXPECT_THAT(box->texts(), Contains("begins archive_io"));
  const Message& last = box->delivered.at(1);
  EXPECT_EQ(last.severity, Severity::kCritical);
  EXPECT_THAT(last.news.detail, HasSubstr("Input/output error"));
}

TEST_F(Notices, WarnThatARunGoesOn) {
  Simulation sim({});
  Dispatcher dispatcher(sim.clock);
  {
    const RunNotices notices(dispatcher, sim.clock, sim.plan, sim.rig_spec,
                             {"run", sim.clock.utc(), true}, channelsInto({box}));
  }
  EXPECT_EQ(box->texts().at(0), "the run goes on");
  EXPECT_EQ(box->delivered.at(0).severity, Severity::kWarning);
}

TEST_F(Notices, LeaveTheHooksThatWereThere) {
  Simulation sim({});
  int frames = 0, statuses = 0;
  Dispatcher dispatcher(sim.clock);
  RunNotices notices(dispatcher, sim.clock, sim.plan, sim.rig_spec, {"run", sim.clock.utc()}, {});
  sim.run([&](SessionHooks& hooks) {
    hooks.on_acknowledged = [&](const db::FrameRow&) { ++frames; };
    hooks.on_status = [&](const SessionStatus&) { ++statuses; };
    notices.hookInto(hooks);
  });
  EXPECT_EQ(frames, 12);
  EXPECT_GT(statuses, 11);
}

}  // namespace
}  // namespace patina::capture::notify
