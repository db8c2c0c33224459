// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/step_runner.h"
#include "tests/sim/full_disk.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::HasSubstr;

std::vector<std::string> twelve(const std::string& decision) {
  return std::vector<std::string>(12, decision);
}

TEST(StepShots, ShootsEveryCameraLightAndExposureOfASweep) {
  Simulation sim({.lights = R"([["key"], ["key", "fill"], []])",
                  .exposures = R"(["1/50", "1/10"])",
                  .cameras = 2});
  const auto summary = sim.run();
  EXPECT_EQ(summary.last.captured, 12);
  const auto step = sim.reader().step(sim.run_id, 5);
  ASSERT_TRUE(step.has_value());
  EXPECT_EQ(step->shots_captured, 12);
  EXPECT_GT(step->spread, 200ms);
  EXPECT_LT(step->spread, 2s);
  sim.expectWhole();
}

TEST(StepShots, CamerasOnOneLineAreFiredTogether) {
  Simulation sim({.rig = "[[trigger]]\nid = \"line\"\nbackend = \"twin\"\n"
                         "cameras = [\"cam0\", \"cam1\"]\n",
                  .cameras = 2});
  EXPECT_EQ(sim.run().last.captured, 12);
  const auto shots = sim.reader().shotsOfStep(sim.reader().step(sim.run_id, 5)->id);
  ASSERT_EQ(shots.size(), 2u);
  EXPECT_EQ(shots[0].began_mono, shots[1].began_mono);
  sim.expectWhole();
}

struct Trouble {
  const char* name;
  const char* fault;
  const char* event;  // that tells of it
};
class ShotInTrouble : public ::testing::TestWithParam<Trouble> {};

TEST_P(ShotInTrouble, CapturesTheStepAllTheSameAndSaysSo) {
  Simulation sim({.faults = std::string("[[fault]]\nat = \"65min\"\ndevice = \"cam0\"\nkind = \"") +
                            GetParam().fault + "\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  EXPECT_FALSE(sim.events(GetParam().event).empty());
  sim.expectWhole();
}

INSTANTIATE_TEST_SUITE_P(OfOneCall, ShotInTrouble,
                         ::testing::Values(Trouble{"hang", "hang", "recover"},
                                           Trouble{"busy", "busy", "recover"},
                                           Trouble{"lost", "lost", "recover"},
                                           Trouble{"partial", "partial_file", "quarantine"},
                                           Trouble{"twice", "duplicate", "stale"},
                                           Trouble{"late", "late", "recover"},
                                           Trouble{"stale", "stale_frame", "recover"},
                                           Trouble{"size", "wrong_size", "quarantine"},
                                           Trouble{"corrupt", "corrupt_bytes", "quarantine"}),
                         [](const auto& trouble) { return std::string(trouble.param.name); });

TEST(StepShots, KnowsAPictureThatComesAgainThoughItNeverReachedTheDisk) {
  Simulation sim({.light_check = "mode = \"uncontrolled\"",
                  .format = "dng",  // every file as long as the other: only its hash tells
                  .faults = "[[fault]]\nat = \"35min\"\ndevice = \"cam0\"\n"
                            "kind = \"stale_frame\"\n"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  const MonoTime full = sim.clock.mono() + 25min, room = full + 10min;
  sim.clock.at(room, [&] { disk.writes_fail = false; });
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.on_light = [&](auto) {
      disk.writes_fail = sim.clock.mono() >= full && sim.clock.mono() < room;
    };
  });
  EXPECT_EQ(sim.reader().step(sim.run_id, 3)->reason, "disk");
  EXPECT_EQ(sim.reader().step(sim.run_id, 4)->retries, 1);
  std::vector<std::string> failed;
  for (const auto& event : sim.events("shot_failed")) failed.push_back(event.detail);
  EXPECT_THAT(failed, Contains(HasSubstr("the previous picture came again")));
  sim.expectWhole();
}

// The disk is full when the failure of the other camera is to be written: the session looks no
// further.
TEST(StepShots, KnowsAPictureThatComesAgainThoughNobodyLookedAtIt) {
  Simulation sim({.light_check = "mode = \"uncontrolled\"",
                  .format = "dng",
                  .cameras = 2,
                  .faults = "[[fault]]\nat = \"25min\"\ndevice = \"cam0\"\nkind = \"late\"\n"
                            "[[fault]]\nat = \"35min\"\ndevice = \"cam1\"\n"
                            "kind = \"stale_frame\"\n"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  const MonoTime full = sim.clock.mono() + 25min, room = full + 10min;
  sim.clock.at(room, [&] { disk.writes_fail = false; });
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.on_light = [&](auto) {
      disk.writes_fail = sim.clock.mono() >= full && sim.clock.mono() < room;
    };
  });
  EXPECT_EQ(sim.reader().step(sim.run_id, 3)->reason, "disk");
  std::vector<std::string> failed;
  for (const auto& event : sim.events("shot_failed")) failed.push_back(event.detail);
  EXPECT_THAT(failed, Contains(HasSubstr("the previous picture came again")));
  sim.expectWhole();
}

TEST(StepShots, RaisesAnAlarmWhenThePictureClips) {
  Simulation sim({.duration = "1h", .exposures = R"(["1/2"])"});
  sim.run();
  std::vector<std::string> alarms;
  for (const auto& event : sim.events("alarm")) alarms.push_back(event.detail);
  EXPECT_THAT(alarms, Contains(HasSubstr("clipping cam0 key begins")));
  EXPECT_THAT(alarms, Contains(HasSubstr("saturated")));
}

}  // namespace
}  // namespace patina::testing
