// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/run_keeper.h"

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <latch>
#include <thread>

#include "tests/capture/app/daemon/bench.h"
#include "tests/capture/notify/receiver.h"
#include "tests/support/matchers.h"

namespace patina::daemon {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

std::vector<std::string> times(int count, const std::string& what) {
  return std::vector<std::string>(static_cast<std::size_t>(count), what);
}

TEST(RunKeeper, RunsAPlanToItsEndAndAsksForItsProducts) {
  Bench bench;
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.stateOf(id), "finished");
  EXPECT_EQ(bench.decisions(id), times(12, "captured"));
  EXPECT_THAT(bench.finished, ::testing::ElementsAre(id));
  EXPECT_THAT(bench.keeper->runs(), IsEmpty());
}

TEST(RunKeeper, FeedsWhatAPlanMakesOfEveryStepAndNothingWhereItAsksForNone) {
  Bench bench;
  testing::writeFile(bench.folder / "fed.toml", testing::readFile(bench.folder / "card.toml") +
                                                    "\n[after]\nsteps = [\"brdf\"]\n");
  const std::string id = bench.start("fed").id;
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.stepped, times(12, id));
  const std::string plain = bench.start().id;
  bench.watcher.waitForEnd(plain);
  EXPECT_EQ(bench.stepped, times(12, id));
}

// HTTP's handlers run at nice 10, for good: capture must not.
TEST(RunKeeper, ARunDoesNotInheritTheLowPriorityOfWhoStartsIt) {
  Bench bench;
  const auto self = [] { return static_cast<id_t>(syscall(SYS_gettid)); };
  int shot_at = 99;
  bench.watcher.on_frame = [&](const std::string&, int) {
    shot_at = getpriority(PRIO_PROCESS, self());
  };
  std::thread([&] {
    setpriority(PRIO_PROCESS, self(), 15);
    bench.watcher.waitForEnd(bench.start().id);
  }).join();
  EXPECT_LE(shot_at, getpriority(PRIO_PROCESS, self()));
}

TEST(RunKeeper, StartingAPlanThatIsGoingOnIsTheSameRun) {
  Bench bench;
  std::string again;
  bench.watcher.on_frame = [&](const std::string&, int count) {
    if (count == 3) again = bench.start().id;
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(again, id);
  EXPECT_THAT(bench.archive->reader().runs(), SizeIs(1));
}

TEST(RunKeeper, SkipsWhatFallsDueWhilePausedAndGoesOn) {
  Bench bench;
  std::string id;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count != 3) return;
    EXPECT_EQ(bench.keeper->pause(run).state, "paused");
  };
  bench.clock.at(bench.clock.mono() + 55min, [&] { bench.keeper->resume("latest"); });
  id = bench.start().id;
  bench.watcher.waitForEnd(id);
  auto expected = times(12, "captured");
  for (std::size_t k : {3, 4, 5}) expected[k] = "skipped: paused";
  EXPECT_EQ(bench.decisions(id), expected);
  EXPECT_EQ(bench.stateOf(id), "finished");
  EXPECT_THAT(bench.watcher.events(), Contains("paused at step 3"));
  EXPECT_THAT(bench.watcher.events(), Contains("continued at step 6"));
}

TEST(RunKeeper, AskedTwiceEachWishIsGrantedOnce) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count != 3) return;
    for (int i = 0; i < 2; ++i) bench.keeper->pause(run);
    for (int i = 0; i < 2; ++i) bench.keeper->shoot(run);
    for (int i = 0; i < 2; ++i) bench.keeper->resume(run);
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  auto expected = times(12, "captured");
  expected.insert(expected.begin(), "by hand captured");
  EXPECT_EQ(bench.decisions(id), expected);
}

TEST(RunKeeper, ShootsByHandWhilePaused) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 2) bench.keeper->pause(run);
  };
  bench.clock.at(bench.clock.mono() + 31min, [&] { bench.keeper->shoot("latest"); });
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  auto expected = times(10, "skipped: paused");
  expected.insert(expected.begin(), {"by hand captured", "captured", "captured"});
  EXPECT_EQ(bench.decisions(id), expected);
}

TEST(RunKeeper, APausedRunStaysPausedOverARestart) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 3) bench.keeper->pause(run);
  };
  // The process is gone before the session has seen the wish: it counts all the same.
  bench.clock.at(bench.clock.mono() + 21min, [&] { throw std::runtime_error("killed"); });
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  bench.open();
  EXPECT_EQ(bench.stateOf(id), "paused");
  bench.clock.advance(5min);
  bench.clock.at(bench.clock.mono() + 30min, [&] { bench.keeper->resume("latest"); });
  bench.watcher.begin(id);
  bench.keeper->takeUp();
  bench.watcher.waitForEnd(id);
  auto expected = times(12, "captured");
  for (std::size_t k : {3, 4, 5}) expected[k] = "skipped: paused";
  EXPECT_EQ(bench.decisions(id), expected);
}

TEST(RunKeeper, StopsAfterTheFrameAndStaysStoppedOverARestart) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 3) bench.keeper->stop(run);
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.decisions(id), times(3, "captured"));
  EXPECT_EQ(bench.stateOf(id), "stopped");
  bench.open();
  bench.keeper->takeUp();
  EXPECT_THAT(bench.keeper->runs(), IsEmpty());
  EXPECT_EQ(bench.keeper->stop(id).state, "stopped");
  bench.watcher.begin(id);
  EXPECT_EQ(bench.start().id, id);  // until the plan is started again
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.decisions(id), times(12, "captured"));
}

TEST(RunKeeper, AbortsForEver) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 3) bench.keeper->abort(run);
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.stateOf(id), "aborted");
  EXPECT_EQ(bench.keeper->abort(id).state, "aborted");
  EXPECT_THROW(bench.keeper->resume(id), capture::CaptureError);
  bench.watcher.on_frame = {};
  const std::string other = bench.start().id;
  bench.watcher.waitForEnd(other);
  EXPECT_NE(other, id);
}

TEST(RunKeeper, ARunThatIsShutDownGoesOnByItself) {
  Bench bench;
  std::latch third{1}, told{1};
  bench.watcher.on_frame = [&](const std::string&, int count) {
    if (count != 3) return;
    third.count_down();
    told.wait();
  };
  const std::string id = bench.start().id;
  third.wait();
  std::thread down([&] { bench.keeper->shutDown(); });
  bench.watcher.on_step = [](const db::StepRow&) {};
  told.count_down();
  down.join();
  EXPECT_THAT(bench.stateOf(id), ::testing::AnyOf("running", "finished"));
  bench.open();
  bench.watcher.begin(id);
  bench.keeper->takeUp();
  if (bench.stateOf(id) != "finished") bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.decisions(id), times(12, "captured"));
}

TEST(RunKeeper, ADeviceThatAnotherRunHoldsIsRefusedByThatRunsName) {
  Bench bench;
  writePlan(bench.folder, "same_camera", "cam0", "fill");
  writePlan(bench.folder, "same_lamp", "cam1", "key");
  std::vector<std::string> refusals;
  std::string id;
  bench.watcher.on_frame = [&](const std::string&, int count) {
    if (count != 3) return;
    for (const char* plan : {"same_camera", "same_lamp"}) try {
        bench.start(plan);
      } catch (const capture::CaptureError& error) {
        EXPECT_EQ(error.exit(), Exit::kTemporary);
        refusals.emplace_back(error.what());
      }
  };
  id = bench.start().id;
  bench.watcher.waitForEnd(id);
  ASSERT_THAT(refusals, SizeIs(2));
  EXPECT_THAT(refusals[0], HasSubstr("cam0 is in use by run " + id));
  EXPECT_THAT(refusals[1], HasSubstr("key is in use by run " + id));
  EXPECT_THAT(bench.archive->reader().runs(), SizeIs(1));
}

TEST(RunKeeper, RunsWhoseDevicesDoNotOverlapGoOnAtOnce) {
  Bench bench;
  writePlan(bench.folder, "other", "cam1", "fill");
  // The first waits in its third frame until the second has gone from its start to its end, and
  // that one until both were seen.
  std::latch waiting{1}, seen{1}, ended{1};
  std::string first;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 3) {
      first = run;
      waiting.count_down();
      ended.wait();
    } else if (count > 3 && run != first) {
      seen.wait();
    }
  };
  bench.start();
  waiting.wait();
  const std::string second = bench.start("other").id;
  EXPECT_THAT(bench.keeper->runs(), SizeIs(2));
  seen.count_down();
  bench.watcher.waitForEnd(second);
  EXPECT_EQ(bench.decisions(second), times(12, "captured"));
  EXPECT_EQ(bench.stateOf(first), "running");
  ended.count_down();
  bench.watcher.waitForEnd(first);
  EXPECT_EQ(bench.stateOf(first), "finished");
}

TEST(RunKeeper, ARunWithoutItsDevicesSaysSoOnceAndIsTriedAgain) {
  Bench bench;
  bench.no_rig = "cam0 is not plugged in";
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  for (int i = 0; i < 3; ++i) {
    bench.watcher.begin(id);
    bench.keeper->retry();
    bench.watcher.waitForEnd(id);
  }
  ASSERT_THAT(bench.keeper->runs(), SizeIs(1));
  EXPECT_EQ(bench.keeper->runs()[0].trouble, bench.no_rig);
  const auto events = bench.watcher.events();
  EXPECT_EQ(std::count(events.begin(), events.end(), "trouble cam0 is not plugged in"), 1);
  bench.no_rig.clear();
  bench.watcher.begin(id);
  bench.keeper->retry();
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.decisions(id), times(12, "captured"));
}

TEST(RunKeeper, GoesOnWithThePlanAsItWasWhateverItsFileSaysNow) {
  Bench bench;
  bench.watcher.on_frame = [&](const std::string&, int count) {
    if (count == 3) throw std::runtime_error("killed");
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  bench.watcher.on_frame = {};
  testing::writeFile(bench.folder / "card.toml", "nonsense");
  testing::writeFile(bench.folder / "rig.toml", "nonsense");
  bench.open();
  bench.watcher.begin(id);
  bench.keeper->takeUp();
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.stateOf(id), "finished");
}

TEST(RunKeeper, APlanThatIsWrongChangesNothing) {
  Bench bench;
  testing::writeFile(bench.folder / "card.toml", "nonsense");
  EXPECT_THROW(bench.start(), Failure);
  EXPECT_THAT(bench.archive->reader().runs(), IsEmpty());
}

TEST(RunKeeper, ANewRunWithoutItsCamerasIsRefusedUnlessItMayWait) {
  Bench bench;
  bench.no_camera = "camera 'cam0' cannot be opened";
  EXPECT_THROW(bench.start(), capture::CaptureError);
  EXPECT_THAT(bench.archive->reader().runs(), IsEmpty());
  EXPECT_THAT(bench.keeper->runs(), IsEmpty());
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    if (count == 3) bench.keeper->stop(run);
  };
  const std::string id = bench.keeper->start(bench.folder / "card.toml", {false, true}).id;
  bench.watcher.waitForEnd(id);
  bench.watcher.begin(id);
  EXPECT_EQ(bench.start().id, id);  // it goes on: nobody looks
  bench.watcher.waitForEnd(id);
  EXPECT_EQ(bench.decisions(id), times(12, "captured"));
  EXPECT_EQ(bench.asked_for_cameras, 1);
}

TEST(RunKeeper, ANewRunIsRefusedWhileTheOldOneOfItsSpecimenGoesOn) {
  Bench bench;
  std::string refusal;
  bench.watcher.on_frame = [&](const std::string&, int count) {
    if (count == 3) try {
        bench.start("card", true);
      } catch (const capture::CaptureError& error) {
        refusal = error.what();
      }
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_THAT(refusal, HasSubstr(id));
  EXPECT_EQ(bench.stateOf(id), "finished");
}

TEST(RunKeeper, WishesForARunThatHasEndedAreRefused) {
  Bench bench;
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_THROW(bench.keeper->pause(id), capture::CaptureError);
  EXPECT_THROW(bench.keeper->resume(id), capture::CaptureError);
  EXPECT_THROW(bench.keeper->stop(id), capture::CaptureError);
  EXPECT_THROW(bench.keeper->abort(id), capture::CaptureError);
  EXPECT_THROW(bench.keeper->shoot(id), capture::CaptureError);
  EXPECT_EQ(bench.stateOf(id), "finished");
}

// What a plan's webhook is sent; all of it by the end of the run.
class Told : public ::testing::Test {
 protected:
  void run(const std::string& alerts) {
    writePlan(bench_.folder, "told", "cam0", "key", alerts);
    bench_.dispatcher = &dispatcher_;
    bench_.open();
    id_ = bench_.start("told").id;
    bench_.watcher.waitForEnd(id_);
  }
  std::string webhook() {
    return "[[alerts.webhook]]\nurl = \"" + hook_.url() + "\"\nleast = \"info\"\n";
  }
  std::vector<std::string> bodies() {
    std::vector<std::string> bodies;
    for (const testing::Request& request : hook_.requests()) bodies.push_back(request.body);
    return bodies;
  }
  testing::Receiver hook_;
  Bench bench_;
  capture::notify::Dispatcher dispatcher_{bench_.clock};
  std::string id_;
};

TEST_F(Told, AreTheBeginningAndTheEndOfARun) {
  run(webhook());
  ASSERT_THAT(bodies(), SizeIs(2));
  EXPECT_THAT(bodies()[0], HasSubstr("the run begins"));
  EXPECT_THAT(bodies()[1], HasSubstr("the run finished: 12 of 12 steps captured"));
  EXPECT_THAT(bodies()[1], HasSubstr(id_));
}

TEST_F(Told, IsWhyNoSessionIsAtWork) {
  bench_.no_rig = "no camera on this bus";
  run(webhook());
  ASSERT_THAT(bodies(), SizeIs(2));
  EXPECT_THAT(bodies()[1], HasSubstr("no camera on this bus"));
  EXPECT_THAT(bodies()[1], HasSubstr("critical"));
}

TEST_F(Told, AreAlertsOfTheSessionToPeopleAndToTheObserver) {
  bench_.clock.at(bench_.clock.mono() + std::chrono::minutes(35),
                  [this] { bench_.clock.stepUtc(std::chrono::hours(3)); });
  run(webhook());
  EXPECT_THAT(bodies(), Contains(HasSubstr("clock_step")));
  EXPECT_THAT(bench_.watcher.alerts(), Contains("begins clock_step"));
}

TEST_F(Told, IsOnlyTheArchiveWhenAChannelCannotBeMade) {
  run("[[alerts.webhook]]\nurl_file = \"not-there.url\"\n");
  EXPECT_THAT(bench_.watcher.events(), Contains(HasSubstr("alerts nothing will be told through")));
  EXPECT_EQ(bench_.stateOf(id_), "finished");
}

}  // namespace
}  // namespace patina::daemon
