// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/capture/app/live_daemon.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

using Daemon = LiveDaemon;

TEST_F(Daemon, GoesOnByItselfAfterASigkillWithNothingLost) {
  beginWithPlan();
  const std::string id = run();
  for (int life = 0; life < 3; ++life) {
    for (int i = 0; i < 4; ++i) EXPECT_THAT(nextAck(), StartsWith("ack " + id));
    EXPECT_EQ(end(SIGKILL).signal, SIGKILL);
    begin();  // nobody names the plan
  }
  nextAck();
  EXPECT_EQ(end(SIGTERM).exit, 0);
  EXPECT_EQ(answer({"archive", "list"}).size("/items"), 1u);
  EXPECT_EQ(ask({"archive", "verify"}).exit, 0);
}

TEST_F(Daemon, SigtermFinishesTheFramesAndLeavesTheRunToGoOn) {
  beginWithPlan();
  const Finished finished = end(SIGTERM);
  EXPECT_EQ(finished.exit, 0) << finished.err;
  EXPECT_THAT(finished.err, HasSubstr("listening on "));
  EXPECT_EQ(state(), "running");
}

TEST_F(Daemon, HasTheArchiveForItselfAndIsNamed) {
  beginWithPlan();
  const Finished second = ask({"daemon", "--port", "0"});
  EXPECT_EQ(second.exit, 75);
  EXPECT_THAT(second.err, HasSubstr(std::to_string(daemon_->pid())));
  EXPECT_THAT(second.err, HasSubstr("patina daemon"));
  EXPECT_EQ(ask({"capture", plan_}).exit, 75);
  EXPECT_EQ(ask({"run", "list"}).exit, 0);
}

TEST_F(Daemon, SighupReadsItsFileAgainAndKeepsTheOldOneWhenTheNewIsWrong) {
  writeFile(files_ / "daemon.toml", "port = 0\n");
  begin({"--start", plan_, "--config", files_ / "daemon.toml"});
  nextAck();
  writeFile(files_ / "daemon.toml", "prot = 0\n");
  daemon_->signal(SIGHUP);
  nextAck();
  const Finished finished = end(SIGTERM);
  EXPECT_EQ(finished.exit, 0);
  EXPECT_THAT(finished.err, HasSubstr("nothing was reloaded: "));
  EXPECT_THAT(finished.err, HasSubstr("daemon.toml:1: prot"));
}

TEST_F(Daemon, WhatIsWrongAtTheStartIsSaidWithItsCode) {
  EXPECT_EQ(ask({"daemon", "--speed", "10", "--port", "0"}).exit, 64);
  writeFile(files_ / "daemon.toml", "port = \"x\"\n");
  EXPECT_EQ(ask({"daemon", "--config", files_ / "daemon.toml"}).exit, 78);
  EXPECT_EQ(ask({"daemon", "--port", "0", "--start", files_ / "nowhere.toml"}).exit, 74);
}

}  // namespace
}  // namespace patina::testing
