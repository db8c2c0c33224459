// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <csignal>

#include "tests/capture/app/ack_pipe.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class Capture : public ::testing::Test {
 protected:
  std::vector<std::string> command() {
    return {program(), "capture", plan_,        "--archive",
            archive_,  "--json",  "--log-acks", pipe_.path()};
  }
  TempFolder files_ = TempFolder::inMemory(), folder_ = TempFolder::inMemory();
  AckPipe pipe_{folder_ / "acks"};
  const std::string plan_ = changedPlan(files_, {{"[\"ttf\", \"film\"]", "[]"}});
  const std::string archive_ = folder_ / "a";
};

TEST_F(Capture, FinishesTheFrameAndStopsOnSigterm) {
  Child child(command());
  EXPECT_THAT(pipe_.line(), ::testing::StartsWith("ack "));
  child.signal(SIGTERM);
  const JsonAnswer answer = answerOf(child.wait());
  EXPECT_EQ(answer.text("/items/0/end"), "stopped");
  EXPECT_EQ(answer.number("/items/0/captured"), 1);
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", archive_}).exit, 0);
}

TEST_F(Capture, ShootsAtOnceOnSigusr1) {
  Child child(command());
  const std::string first = pipe_.line();
  child.signal(SIGUSR1);
  const std::string second = pipe_.line();
  EXPECT_NE(first, second);
  child.signal(SIGTERM);
  answerOf(child.wait());
  const std::vector<std::string> query = {"archive", "query", "--archive", archive_, "--json"};
  const JsonAnswer steps = answerOf(runPatina(query));
  ASSERT_EQ(steps.size("/items"), 2u);
  EXPECT_TRUE(std::isnan(steps.number("/items/0/number")) !=
              std::isnan(steps.number("/items/1/number")));
}

TEST_F(Capture, RefusesANewRunWithoutItsCameraUnlessItMayWait) {
  writeFile(files_ / "rig.toml",
            "name = \"door\"\n[[camera]]\nid = \"cam0\"\nbackend = \"network\"\nsettings = { url = "
            "\"http://127.0.0.1:1/\", fixed_exposure = \"1/100\" }\n");
  writeFile(files_ / "door.toml",
            "rig = \"rig.toml\"\nspecimen = \"door\"\ninterval = \"1s\"\nduration = \"2s\"\n"
            "[[sweep]]\nlights = [[]]\nexposures = [\"1/100\"]\n");
  std::vector<std::string> capture = {"capture", files_ / "door.toml", "--archive", archive_,
                                      "--json"};
  const Finished refused = runPatina(capture);
  EXPECT_EQ(refused.exit, 69);
  EXPECT_THAT(refused.err, ::testing::HasSubstr("camera 'cam0' cannot be opened"));
  const std::vector<std::string> list = {"archive", "list", "--archive", archive_, "--json"};
  EXPECT_EQ(answerOf(runPatina(list)).size("/items"), 0u);
  capture.push_back("--wait");
  const JsonAnswer answer = answerOf(runPatina(capture));
  EXPECT_EQ(answer.number("/items/0/failed") + answer.number("/items/0/skipped"), 2);
}

TEST_F(Capture, HasTheArchiveForItself) {
  Child child(command());
  pipe_.line();
  const Finished second = runPatina({"capture", plan_, "--archive", archive_});
  EXPECT_EQ(second.exit, 75);
  EXPECT_THAT(second.err, ::testing::HasSubstr(std::to_string(child.pid())));
  EXPECT_EQ(runPatina({"archive", "list", "--archive", archive_}).exit, 0);  // readers may
  child.signal(SIGTERM);
  child.wait();
}

TEST_F(Capture, KilledItGoesOnWithTheSameRun) {
  changedPlan(files_, {{"[\"ttf\", \"film\"]", "[]"}, {"\"10min\"", "\"1s\""}});
  const std::string run = [&] {
    Child child(command());
    const std::string first = pipe_.line();
    child.signal(SIGKILL);
    child.wait();
    return first.substr(0, first.find(' ', 4));
  }();
  Child child(command());
  for (int i = 0; i < 3; ++i)  // a line or two of the first one may still have been in the pipe
    EXPECT_THAT(pipe_.line(), ::testing::StartsWith(run));
  child.signal(SIGINT);
  EXPECT_EQ(child.wait().exit, 130);
  const std::vector<std::string> list = {"archive", "list", "--archive", archive_, "--json"};
  EXPECT_EQ(answerOf(runPatina(list)).size("/items"), 1u);
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", archive_}).exit, 0);
}

}  // namespace
}  // namespace patina::testing
