// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/live_daemon.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

using RunVerbs = LiveDaemon;

TEST_F(RunVerbs, WithoutADaemonEveryVerbSaysHowToStartOne) {
  for (const char* verb : {"list", "status", "watch"}) {
    const Finished finished = ask({"run", verb});
    EXPECT_EQ(finished.exit, 69) << verb;
    EXPECT_THAT(finished.err, HasSubstr("patina daemon --archive")) << verb;
  }
}

TEST_F(RunVerbs, StartsARunAndTheSamePlanTwiceIsOneRun) {
  begin();
  const auto first = answer({"run", "start", plan_});
  nextAck();
  EXPECT_EQ(answer({"run", "start", plan_}).text("/items/0/id"), first.text("/items/0/id"));
  EXPECT_EQ(answer({"run", "list"}).size("/items"), 1u);
  EXPECT_EQ(answer({"run", "status"}).text("/items/0/state"), "running");
  EXPECT_THAT(ask({"run", "status"}).out, HasSubstr("keeps"));
}

TEST_F(RunVerbs, APausedRunStaysPausedOverASigkill) {
  beginWithPlan();
  const std::string id = run();
  EXPECT_EQ(answer({"run", "pause", id}).text("/items/0/state"), "paused");
  EXPECT_EQ(answer({"run", "pause", "latest"}).text("/items/0/state"), "paused");
  end(SIGKILL);
  begin();
  EXPECT_EQ(answer({"run", "status", id}).text("/items/0/state"), "paused");
  EXPECT_EQ(answer({"run", "shoot", id}).text("/items/0/state"), "paused");
  nextAck();  // the manual shot, or one of before
  EXPECT_EQ(answer({"run", "resume", id}).text("/items/0/state"), "running");
  nextAck();
  EXPECT_EQ(end(SIGTERM).exit, 0);
}

TEST_F(RunVerbs, AStoppedRunStaysStoppedAndAnAbortedOneForEver) {
  beginWithPlan();
  const std::string id = run();
  EXPECT_EQ(answer({"run", "stop", id}).text("/items/0/state"), "stopped");
  end(SIGKILL);
  begin();
  EXPECT_EQ(answer({"run", "status"}).size("/items"), 0u);
  EXPECT_EQ(answer({"run", "abort", id}).text("/items/0/state"), "aborted");
  const Finished resumed = ask({"run", "resume", id});
  EXPECT_EQ(resumed.exit, 64);
  EXPECT_THAT(resumed.err, HasSubstr("aborted"));
}

TEST_F(RunVerbs, TheDaemonsRefusalIsTheCommandsOwn) {
  beginWithPlan();
  writeFile(files_ / "other.toml", readFile(files_ / "plan.toml") + "# another plan\n");
  const Finished same_specimen = ask({"run", "start", files_ / "other.toml"});
  EXPECT_EQ(same_specimen.exit, 75);
  EXPECT_THAT(same_specimen.err, HasSubstr(run()));
  writeFile(files_ / "wrong.toml", "nonsense\n");
  EXPECT_EQ(ask({"run", "start", files_ / "wrong.toml"}).exit, 78);
  EXPECT_EQ(ask({"run", "pause", "nobody"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
