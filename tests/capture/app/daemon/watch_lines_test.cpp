// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/watch_lines.h"

#include <gmock/gmock.h>

#include "capture/app/daemon/json_rows.h"
#include "tests/capture/app/daemon/live_view.h"

namespace patina::daemon {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::SizeIs;

std::string alert(const std::string& run, const std::string& what, bool over) {
  return jsonOf(Alert{run, what, "timeout", {}}, over);
}

TEST(WatchLines, TheScreenHasALinePerCameraAndLightNextStepAndDisk) {
  WatchLines lines("");
  lines.take({liveView()});
  EXPECT_THAT(lines.screen(120), ElementsAre("20240501T120000Z-card  running  step 12/1008  next "
                                             "2024-05-01T14:10:00  captured 11  missed 1",
                                             "  cam0  up  shots 11  newest 2024-05-01T14:00:02",
                                             "  cam1  DOWN  shots 0  failed 3  timeout: no picture",
                                             "  light key 0.998 pass  disk 12 GB"));
}

TEST(WatchLines, NoLineIsLongerThanTheTerminal) {
  WatchLines lines("");
  lines.take({liveView()});
  EXPECT_THAT(lines.screen(20), Each(SizeIs(::testing::Le(20u))));
}

TEST(WatchLines, SaysAChangeOnce) {
  WatchLines lines("");
  const std::string json = jsonOf(liveView());
  EXPECT_THAT(lines.take("status", json), HasSubstr("step 12/1008"));
  EXPECT_EQ(lines.take("status", json), "");
  RunView later = liveView();
  later.status.step = 13;
  EXPECT_THAT(lines.take("status", jsonOf(later)), HasSubstr("step 13/1008"));
}

TEST(WatchLines, AlertsStandUntilTheyAreOver) {
  WatchLines lines("");
  lines.take({liveView()});
  const auto calm = lines.screen(100).size();
  EXPECT_THAT(lines.take("alert", alert("r", "camera cam1 down", false)), HasSubstr("ALERT"));
  EXPECT_EQ(lines.screen(100).size(), calm + 1);
  EXPECT_THAT(lines.take("alert", alert("r", "camera cam1 down", true)), HasSubstr("over"));
  EXPECT_EQ(lines.screen(100).size(), calm);
}

TEST(WatchLines, OneRunIsWatchedAloneUntilItEnds) {
  RunView view = liveView();
  WatchLines lines(view.id);
  RunView other = view;
  other.id = "other";
  EXPECT_EQ(lines.take("status", jsonOf(other)), "");
  EXPECT_EQ(lines.take("alert", alert("other", "dark", false)), "");
  lines.take("status", jsonOf(view));
  EXPECT_FALSE(lines.over());
  view.state = "finished";
  view.active = false;
  EXPECT_THAT(lines.take("run", jsonOf(view)), HasSubstr("finished"));
  EXPECT_TRUE(lines.over());
}

TEST(WatchLines, AStateThatIsAskedForIsSaidOnceToo) {
  WatchLines lines("");
  EXPECT_THAT(lines.take({liveView()}), SizeIs(1));
  EXPECT_THAT(lines.take({liveView()}), ::testing::IsEmpty());
  RunView ended = liveView();
  ended.state = "stopped";
  ended.active = false;
  WatchLines alone(ended.id);
  alone.take({ended});
  EXPECT_TRUE(alone.over());
}

TEST(WatchLines, WhatADriverSaysDoesNotSteerTheTerminal) {
  RunView view = liveView();
  view.cameras[1].status.trouble = "\x1b[2Jgone\n";
  WatchLines lines("");
  lines.take({view});
  for (const std::string& line : lines.screen(200))
    EXPECT_EQ(line.find_first_of("\x1b\n"), std::string::npos);
}

TEST(WatchLines, WithoutARunItSaysSo) {
  EXPECT_THAT(WatchLines("").screen(80), ElementsAre("no run is going on"));
}

}  // namespace
}  // namespace patina::daemon
