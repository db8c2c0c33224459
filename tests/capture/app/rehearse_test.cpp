// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <csignal>

#include "tests/capture/app/ack_pipe.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

TEST(Rehearse, RepeatsItselfToTheByteOfItsEventLog) {
  const TempFolder folder = TempFolder::inMemory();
  const TempFolder files = TempFolder::inMemory();
  const std::string plan = changedPlan(files, {{"[\"ttf\", \"film\"]", "[]"}});
  const auto rehearse = [&](const std::string& archive) {
    return answerOf(runPatina({"rehearse", plan, "--archive", folder / archive, "--json"}));
  };
  const JsonAnswer one = rehearse("one"), two = rehearse("two");
  EXPECT_EQ(one.number("/items/0/captured"), 12);
  EXPECT_EQ(one.text("/items/0/run_id"), "20240501T120000Z-copper");
  EXPECT_EQ(one.text("/items/0/event_log_sha256"), two.text("/items/0/event_log_sha256"));
}

TEST(Rehearse, BuildsTextureAndFilmOnceAndAddsNothingWhenRunAgain) {
  const TempFolder folder = TempFolder::inMemory();
  const std::vector<std::string> command = {"rehearse", quickPlan(), "--archive", folder / "a",
                                            "--json"};
  const JsonAnswer first = answerOf(runPatina(command));
  ASSERT_EQ(first.size("/items/0/products"), 2u);
  EXPECT_TRUE(std::filesystem::exists(first.text("/items/0/products/1")));
  EXPECT_EQ(answerOf(runPatina(command)).size("/items/0/products"), 2u);
  const std::vector<std::string> list = {"archive", "list", "--archive", folder / "a", "--json"};
  EXPECT_EQ(answerOf(runPatina(list)).size("/items"), 1u);
}

TEST(Rehearse, ANewRunComesAfterTheOldOne) {
  const TempFolder folder = TempFolder::inMemory();
  const TempFolder files = TempFolder::inMemory();
  const std::string plan = changedPlan(files, {{"[\"ttf\", \"film\"]", "[]"}});
  answerOf(runPatina({"rehearse", plan, "--archive", folder / "a"}));
  const JsonAnswer second =
      answerOf(runPatina({"rehearse", plan, "--archive", folder / "a", "--new-run", "--json"}));
  EXPECT_EQ(second.text("/items/0/run_id"), "20240502T120000Z-copper");
}

TEST(Rehearse, ARigOfRealDevicesIsRefused) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string plan =
      changedPlan(folder, {}, "backend = \"twin\"\nsettings", "backend = \"gphoto2\"\nsettings");
  const Finished finished = runPatina({"rehearse", plan, "--archive", folder / "a"});
  EXPECT_EQ(finished.exit, 69);
  EXPECT_THAT(finished.err, HasSubstr("twin"));
}

TEST(Rehearse, AChangedPlanOfAnUnfinishedRunIsRefusedUnlessANewRunIsMeant) {
  const TempFolder folder = TempFolder::inMemory();
  const TempFolder files = TempFolder::inMemory();
  const AckPipe pipe(folder / "acks");
  const std::string plan = changedPlan(files, {{"\"2h\"", "\"2000h\""}});
  Child child({program(), "rehearse", plan, "--archive", folder / "a", "--log-acks", pipe.path()});
  pipe.line();
  child.signal(SIGTERM);
  EXPECT_EQ(child.wait().exit, 0);
  const std::string changed = changedPlan(files, {{"[\"ttf\", \"film\"]", "[]"}});
  EXPECT_EQ(runPatina({"rehearse", changed, "--archive", folder / "a"}).exit, 75);
  EXPECT_EQ(runPatina({"rehearse", changed, "--archive", folder / "a", "--new-run"}).exit, 0);
}

}  // namespace
}  // namespace patina::testing
