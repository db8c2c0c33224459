// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/active_run.h"

#include <gmock/gmock.h>

#include "tests/capture/app/daemon/bench.h"

namespace patina::daemon {
namespace {

db::RunRow row(const std::string& state) {
  db::RunRow row;
  row.id = "r";
  row.state = state;
  return row;
}

db::ShotRow shotBy(const std::string& camera, db::ShotState state) {
  db::ShotRow shot;
  shot.device_id = camera;
  shot.state = state;
  return shot;
}

TEST(ActiveRun, KnowsOfEachCameraWhatItDidAndItsNewestFrame) {
  Watcher watcher;
  Spawner spawner;
  ActiveRun run(watcher, spawner, row("running"), "plan.toml");
  run.begin([](ActiveRun&, const capture::SessionHooks& hooks) {
    hooks.on_shot(shotBy("cam0", db::ShotState::kFailed));
    hooks.on_shot(shotBy("cam1", db::ShotState::kCaptured));
    db::FrameRow frame;
    frame.id = 7;
    hooks.on_acknowledged(frame);
    capture::SessionStatus status;
    status.cameras = {{"cam0", false, "timeout"}, {"cam1", true, ""}};
    hooks.on_status(status);
  });
  watcher.waitForEnd("r");
  const RunView view = run.view();
  ASSERT_EQ(view.cameras.size(), 2u);
  EXPECT_EQ(view.cameras[0].failed, 1);
  EXPECT_FALSE(view.cameras[0].status.up);
  EXPECT_FALSE(view.cameras[0].newest);
  EXPECT_EQ(view.cameras[1].captured, 1);
  EXPECT_EQ(view.cameras[1].newest->id, 7);
}

TEST(ActiveRun, BeginsPausedWhenItWas) {
  Watcher watcher;
  bool paused = false;
  Spawner spawner;
  ActiveRun run(watcher, spawner, row("paused"), "plan.toml");
  run.begin([&](ActiveRun&, const capture::SessionHooks& hooks) { paused = *hooks.paused; });
  watcher.waitForEnd("r");
  EXPECT_TRUE(paused);
}

TEST(ActiveRun, AnAbortIsAStopToo) {
  Watcher watcher;
  Spawner spawner;
  ActiveRun run(watcher, spawner, row("running"), "plan.toml");
  run.begin([&](ActiveRun& self, const capture::SessionHooks& hooks) {
    self.askToAbort();
    EXPECT_TRUE(hooks.stop.stop_requested());
    EXPECT_TRUE(hooks.abort.stop_requested());
  });
  watcher.waitForEnd("r");
}

TEST(ActiveRun, CanBeginAgain) {
  Watcher watcher;
  Spawner spawner;
  ActiveRun run(watcher, spawner, row("running"), "plan.toml");
  run.begin([](ActiveRun& self, const capture::SessionHooks&) { self.askToStop(); });
  watcher.waitForEnd("r");
  watcher.begin("r");
  run.begin([](ActiveRun&, const capture::SessionHooks& hooks) {
    EXPECT_FALSE(hooks.stop.stop_requested());
  });
  watcher.waitForEnd("r");
}

TEST(ActiveRun, TheSameTroubleIsNewsOnce) {
  Watcher watcher;
  Spawner spawner;
  ActiveRun run(watcher, spawner, row("running"), "plan.toml");
  EXPECT_TRUE(run.setTrouble("gone"));
  EXPECT_FALSE(run.setTrouble("gone"));
  EXPECT_TRUE(run.setTrouble("full"));
}

}  // namespace
}  // namespace patina::daemon
