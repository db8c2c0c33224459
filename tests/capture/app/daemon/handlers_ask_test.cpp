// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/daemon/routes_bench.h"

namespace patina::daemon {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string wish(const std::filesystem::path& plan) {
  return jsonOf(StartWish{plan.string(), false});
}

TEST(HandlersAsk, AnOperatorOfTheMachineStartsAnyPlan) {
  RoutesBench bench;
  const auto started = bench.post("/api/v1/runs", {}, wish(bench.folder / "card.toml"), true);
  const auto views = runsOf(started.body);
  ASSERT_EQ(views.size(), 1u);
  bench.watcher.waitForEnd(views[0].id);
  EXPECT_EQ(bench.stateOf(views[0].id), "finished");
}

TEST(HandlersAsk, TheNetworkStartsOnlyWhatWasLaidOutForIt) {
  RoutesBench bench;
  const auto plans = bench.folder / "plans";
  std::filesystem::create_directories(plans);
  std::filesystem::create_symlink(bench.folder / "card.toml", plans / "link.toml");
  const auto refused = [&](const std::string& plan) {
    try {
      bench.post("/api/v1/runs", {}, wish(plan));
    } catch (const capture::CaptureError& error) {
      return error.exit() == Exit::kPermission;
    }
    return false;
  };
  EXPECT_TRUE(refused("card.toml"));  // no folder of plans at all
  bench.plans = plans;
  for (const std::string& plan :
       {(bench.folder / "card.toml").string(), std::string("../card.toml"), std::string("."),
        std::string("link.toml"), std::string("x/../../card.toml"), std::string("/etc/passwd"),
        (bench.folder / "plans-other/card.toml").string()})
    EXPECT_TRUE(refused(plan)) << plan;
  EXPECT_THAT(bench.archive->reader().runs(), IsEmpty());

  bench.plans = bench.folder.path();
  const auto views = runsOf(bench.post("/api/v1/runs", {}, wish("card.toml")).body);
  ASSERT_EQ(views.size(), 1u);
  bench.watcher.waitForEnd(views[0].id);
}

TEST(HandlersAsk, ABodyThatIsNoWishIsRefused) {
  RoutesBench bench;
  for (const char* body : {"", "{}", "[]", "{\"plan\":3}"})
    EXPECT_THROW(bench.post("/api/v1/runs", {}, body, true), capture::CaptureError) << body;
}

TEST(HandlersAsk, WishesGoToTheRunThatIsNamed) {
  RoutesBench bench;
  std::vector<std::string> states;
  bench.watcher.on_frame = [&](const std::string& run, int count) {
    const auto ask = [&](const std::string& verb) {
      states.push_back(
          runsOf(bench.post("/api/v1/runs/{run}/" + verb, {{"run", run}}).body).at(0).state);
    };
    if (count == 2) ask("pause"), ask("shoot"), ask("resume");
    if (count == 4) ask("stop");
  };
  const std::string id = bench.start().id;
  bench.watcher.waitForEnd(id);
  EXPECT_THAT(states, ::testing::ElementsAre("paused", "paused", "running", "stopped"));
  EXPECT_EQ(runsOf(bench.post("/api/v1/runs/{run}/abort", {{"run", id}}).body).at(0).state,
            "aborted");
}

TEST(HandlersAsk, ARunThatIsNotThereIsNotFound) {
  RoutesBench bench;
  for (const char* verb : {"pause", "resume", "stop", "abort", "shoot"})
    EXPECT_EQ(bench.post(std::string("/api/v1/runs/{run}/") + verb, {{"run", "nobody"}}).status,
              404)
        << verb;
}

TEST(HandlersAsk, AReloadSaysWhatItChanged) {
  RoutesBench bench;
  bench.reloaded = "plans \"x\"";
  EXPECT_THAT(bench.post("/api/v1/reload").body, HasSubstr("\"changed\":\"plans \\\"x\\\"\""));
}

}  // namespace
}  // namespace patina::daemon
