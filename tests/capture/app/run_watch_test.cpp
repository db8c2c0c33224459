// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/live_daemon.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

using RunWatch = LiveDaemon;

TEST_F(RunWatch, OnAPipeAChangeIsALineUntilTheRunEnds) {
  beginWithPlan();
  const std::string id = run();
  const std::string shell =
      program().string() + " run watch " + id + " --archive " + archive() + " | head -n 3";
  const Finished watched = testing::run({"/bin/sh", "-c", shell}, environment_);
  EXPECT_EQ(std::count(watched.out.begin(), watched.out.end(), '\n'), 3) << watched.err;
  EXPECT_THAT(watched.out, HasSubstr(id + "  running  step "));
}

TEST_F(RunWatch, JsonIsALineAnEvent) {
  beginWithPlan();
  const std::string shell =
      program().string() + " run watch --json --archive " + archive() + " | head -n 5";
  const Finished watched = testing::run({"/bin/sh", "-c", shell}, environment_);
  std::istringstream lines(watched.out);
  int count = 0;
  for (std::string line; std::getline(lines, line); ++count)
    EXPECT_TRUE(JsonAnswer(line).has("/data")) << line;
  EXPECT_EQ(count, 5) << watched.err;
}

TEST_F(RunWatch, EndsWithTheRunThatItWatches) {
  beginWithPlan();
  const std::string id = run();
  Child watching({program(), "run", "watch", id, "--json", "--archive", archive()}, environment_);
  EXPECT_EQ(answer({"run", "stop", id}).text("/items/0/state"), "stopped");
  const Finished watched = watching.wait();
  EXPECT_EQ(watched.exit, 0) << watched.err;
}

}  // namespace
}  // namespace patina::testing
