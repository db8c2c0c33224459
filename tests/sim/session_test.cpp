// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/sim/full_disk.h"
#include "tests/sim/simulation.h"

namespace patina::testing {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::Each;
using ::testing::HasSubstr;

std::vector<std::string> twelve(const std::string& decision) {
  return std::vector<std::string>(12, decision);
}

TEST(Session, CapturesEveryStepOfAQuietRun) {
  Simulation sim({});
  const auto summary = sim.run();
  EXPECT_EQ(summary.end, "finished");
  EXPECT_EQ(summary.last.captured, 12);
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  sim.expectWhole();
  EXPECT_EQ(sim.reader().runs().back().state, "finished");
}

TEST(Session, WritesTheSameHashForTheSameSeedAndAnotherForAnother) {
  Simulation a({}), b({}), c({.seed = 2});
  const std::string first = a.run().event_log_sha256;
  EXPECT_EQ(first.size(), 64u);
  EXPECT_EQ(b.run().event_log_sha256, first);
  EXPECT_NE(c.run().event_log_sha256, first);
}

TEST(Session, ShootsEveryCameraLightAndExposureOfASweep) {
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

struct Trouble {
  const char* name;
  const char* fault;
  const char* event;  // that tells of it
};
class SessionInTrouble : public ::testing::TestWithParam<Trouble> {};

TEST_P(SessionInTrouble, CapturesTheStepAllTheSameAndSaysSo) {
  Simulation sim({.faults = std::string("[[fault]]\nat = \"65min\"\ndevice = \"cam0\"\nkind = \"") +
                            GetParam().fault + "\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  EXPECT_FALSE(sim.events(GetParam().event).empty());
  sim.expectWhole();
}

INSTANTIATE_TEST_SUITE_P(OfOneCall, SessionInTrouble,
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

TEST(Session, TakesACameraDownAndGoesOnWithTheOther) {
  Simulation sim({.duration = "3h",
                  .cameras = 2,
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"cam1\"\nkind = \"hang\"\n"
                            "duration = \"60min\"\n"});
  sim.run();
  const auto decisions = sim.decisions();
  EXPECT_EQ(std::count(decisions.begin(), decisions.end(), "failed"), 6);
  for (const auto& step : sim.reader().steps(sim.run_id, db::Decision::kFailed)) {
    EXPECT_EQ(step.shots_captured, 1);
    EXPECT_THAT(step.reason, HasSubstr("cam1: timeout"));
  }
  EXPECT_EQ(decisions[12], "captured");  // within two intervals of the fault's end
  const auto alarms = sim.events("alarm");
  ASSERT_EQ(alarms.size(), 2u);
  EXPECT_THAT(alarms[0].detail, HasSubstr("camera cam1 down begins"));
  EXPECT_THAT(alarms[1].detail, HasSubstr("is over"));
  sim.expectWhole();
}

TEST(Session, HoldsWhileALampIsDeadAndGoesOnByItself) {
  Simulation sim({.duration = "3h",
                  .faults = "[[fault]]\nat = \"75min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"
                            "duration = \"40min\"\n"});
  sim.run();
  std::vector<std::string> expected(18, "captured");
  for (std::size_t k : {8, 9, 10}) expected[k] = "held";
  EXPECT_EQ(sim.decisions(), expected);
  const auto back = sim.reader().step(sim.run_id, 11);  // dead until 115 min, due at 110
  EXPECT_GT(back->held, 4min);
  EXPECT_GT(back->retries, 0);
  EXPECT_THAT(sim.reader().step(sim.run_id, 9)->reason, HasSubstr("light key: patch:cam0"));
  EXPECT_THAT(sim.events("alarm").back().detail, HasSubstr("light key is over"));
  sim.expectWhole();
}

TEST(Session, ShootsTheOtherLightsWhileOneIsHeld) {
  Simulation sim({.lights = R"([["key"], ["fill"]])",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  const auto step = sim.reader().step(sim.run_id, 7);
  EXPECT_EQ(step->decision, db::Decision::kHeld);
  EXPECT_EQ(step->shots_captured, 1);
  sim.expectWhole();
}

TEST(Session, AsksSeldomerTheLongerALightStaysAway) {
  Simulation sim({.duration = "24h",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  const auto last = sim.reader().step(sim.run_id, 143);
  EXPECT_EQ(last->decision, db::Decision::kHeld);
  EXPECT_LE(sim.reader().shotsOfStep(last->id).size(), 4u);
}

TEST(Session, NeverHoldsInUncontrolledLight) {
  Simulation sim({.light_check = "mode = \"uncontrolled\"",
                  .faults = "[[fault]]\nat = \"55min\"\ndevice = \"key\"\nkind = \"lamp_dead\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  for (const auto& check : sim.reader().lightChecks(sim.run_id))
    EXPECT_EQ(check.verdict, "measure");
  sim.expectWhole();
}

TEST(Session, HoldsOutsideTheBandOfATemperature) {
  // The twin's room swings between 18 and 22 degrees, coolest at 03:00.
  Simulation sim({.interval = "30min",
                  .duration = "24h",
                  .rig = "[[sensor]]\nid = \"air\"\nbackend = \"twin\"\nquantity = "
                         "\"temperature\"\nband = [19.0, 25.0]\n"});
  sim.run();
  const auto decisions = sim.decisions();
  EXPECT_EQ(decisions[0], "captured");
  EXPECT_EQ(decisions[30], "held");  // 03:00
  EXPECT_EQ(decisions[47], "captured");
  EXPECT_THAT(sim.reader().step(sim.run_id, 30)->reason, HasSubstr("temperature air"));
  EXPECT_TRUE(sim.reader().shotsOfStep(sim.reader().step(sim.run_id, 30)->id).empty());
  sim.expectWhole();
}

TEST(Session, GoesOnWithoutASensorThatFallsSilent) {
  Simulation sim({.rig = "[[sensor]]\nid = \"lux0\"\nbackend = \"twin\"\nquantity = "
                         "\"illuminance\"\n",
                  .faults = "[[fault]]\nat = \"35min\"\ndevice = \"lux0\"\nkind = "
                            "\"sensor_silent\"\nduration = \"30min\"\n"});
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  int silent = 0;
  for (const auto& reading : sim.reader().readings(sim.run_id))
    silent += reading.quality == "silent" ? 1 : 0;
  EXPECT_EQ(silent, 3);
  EXPECT_EQ(sim.events("alarm").size(), 2u);
}

TEST(Session, StopsAfterTheFrameAndGoesOnAtTheNextStep) {
  Simulation sim({.lights = R"([["key"], ["fill"]])"});
  std::stop_source stop;
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.stop = stop.get_token();
    hooks.on_acknowledged = [&, n = 0](const db::FrameRow&) mutable {
      if (++n == 7) stop.request_stop();
    };
  });
  EXPECT_EQ(sim.reader().runs().back().state, "stopped");
  const auto step = sim.reader().step(sim.run_id, 3);
  EXPECT_EQ(step->shots_captured, 1);
  EXPECT_EQ(step->decision, db::Decision::kMissed);
  const auto summary = sim.run();
  EXPECT_EQ(summary.end, "finished");
  EXPECT_EQ(sim.reader().runs().size(), 1u);
  EXPECT_EQ(summary.last.captured, 11);
  EXPECT_EQ(summary.last.partial, 1);
  sim.expectWhole();
}

struct Killed {};
class SessionKilled : public ::testing::TestWithParam<int> {};

TEST_P(SessionKilled, GoesOnByItselfWithNothingLostOrDoubled) {
  Simulation sim({.faults = "[[fault]]\nat = \"20h\"\ndevice = \"cam0\"\nkind = \"busy\"\n"});
  std::vector<db::FrameRow> acknowledged;
  int commits = 0;
  sim.archive_options.at_point = [&](db::CommitPoint point) {
    if (point == static_cast<db::CommitPoint>(GetParam()) && ++commits == 5) throw Killed{};
  };
  const auto keep = [&](capture::SessionHooks& hooks) {
    hooks.on_acknowledged = [&](const db::FrameRow& frame) { acknowledged.push_back(frame); };
  };
  EXPECT_THROW(sim.run(keep), Killed);
  sim.archive_options.at_point = {};
  sim.clock.advance(25min);
  EXPECT_EQ(sim.run(keep).end, "finished");
  sim.expectWhole();
  std::size_t found = 0;
  sim.reader().eachFrame(sim.run_id, [&](const db::ArchiveReader::CapturedFrame& f) {
    for (const auto& frame : acknowledged) found += frame.sha256 == f.frame.sha256 ? 1 : 0;
  });
  EXPECT_EQ(found, acknowledged.size());
  EXPECT_THAT(sim.decisions(), Contains(std::string("missed")));
}

INSTANTIATE_TEST_SUITE_P(AtEveryPoint, SessionKilled, ::testing::Range(0, db::kCommitPointCount));

TEST(Session, IsTiedToUtcAgainAfterAReboot) {
  Simulation sim({});
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 33min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  sim.clock.reboot(30min, "virtual-boot-2", monoFromNs(5'000'000'000));
  sim.run();
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {4, 5, 6}) expected[k] = "missed";
  // 63 minutes after the start: step 6 was due 3 minutes ago, less than half an interval.
  expected[6] = "captured";
  EXPECT_EQ(sim.decisions(), expected);
  EXPECT_THAT(sim.events("resumed").back().detail, HasSubstr("rebooted"));
  sim.expectWhole();
}

TEST(Session, RecordsWhatASuspendMissedWithoutABurst) {
  Simulation sim({});
  sim.clock.at(sim.clock.mono() + 25min, [&] { sim.clock.suspend(44min); });
  sim.run();
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5, 6}) expected[k] = "missed";
  EXPECT_EQ(sim.decisions(), expected);
  sim.expectWhole();
}

TEST(Session, KeepsItsRhythmWhenTheClockIsStepped) {
  Simulation sim({});
  const MonoTime begin = sim.clock.mono();
  sim.clock.at(begin + 25min, [&] { sim.clock.stepUtc(-3h); });
  sim.clock.at(begin + 45min, [&] { sim.clock.stepUtc(5h); });
  sim.run();
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  EXPECT_EQ(sim.events("clock_step").size(), 2u);
  std::vector<MonoTime> at;
  sim.reader().eachFrame(
      sim.run_id, [&](const db::ArchiveReader::CapturedFrame& f) { at.push_back(f.frame.mono); });
  ASSERT_EQ(at.size(), 12u);
  for (std::size_t k = 0; k < 12; ++k) EXPECT_LT(at[k] - begin - k * 10min, 1s);
  sim.expectWhole();
}

TEST(Session, ShootsByHandBetweenSteps) {
  Simulation sim({});
  std::atomic<bool> now{false};
  sim.clock.at(sim.clock.mono() + 14min, [&] { now = true; });
  sim.run([&](capture::SessionHooks& hooks) { hooks.shoot_now = &now; });
  int by_hand = 0;
  for (const auto& step : sim.reader().steps(sim.run_id))
    if (!step.number) {
      ++by_hand;
      EXPECT_EQ(step.decision, db::Decision::kCaptured);
    }
  EXPECT_EQ(by_hand, 1);
  EXPECT_EQ(sim.decisions(), twelve("captured"));
  sim.expectWhole();
}

TEST(Session, RefusesAPlanThatWasEditedWhileItsRunIsUnfinished) {
  Simulation sim({});
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 33min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  const std::string first = sim.run_id;
  sim.plan = capture::parsePlan(sim.plan.toml + "band = 0.05\n", sim.plan.source);
  try {
    sim.run();
    FAIL() << "accepted";
  } catch (const capture::CaptureError& error) {
    EXPECT_THAT(error.what(), HasSubstr(first));
    EXPECT_THAT(error.what(), HasSubstr("--new-run"));
  }
  sim.session_options.new_run = true;
  EXPECT_EQ(sim.run().end, "finished");
  EXPECT_NE(sim.run_id, first);
  EXPECT_EQ(sim.reader().runs().front().state, "aborted");
}

TEST(Session, StopsCleanlyBeforeTheDiskIsFullAndGoesOnWhenThereIsRoom) {
  Simulation sim({.plan = "[disk]\nreserve = \"1GB\"\n"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  sim.clock.at(sim.clock.mono() + 25min, [&] { disk.free_bytes = 1'000'000'000; });
  sim.clock.at(sim.clock.mono() + 65min, [&] { disk.free_bytes = 5'000'000'000; });
  const auto summary = sim.run();
  EXPECT_EQ(summary.end, "finished");
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5, 6}) expected[k] = "skipped";
  EXPECT_EQ(sim.decisions(), expected);
  EXPECT_EQ(sim.reader().step(sim.run_id, 4)->reason, "disk");
  EXPECT_EQ(sim.events("disk").size(), 2u);
  sim.expectWhole();
}

TEST(Session, LosesNothingWhenTheDiskIsFullWithoutWarning) {
  Simulation sim({.lights = R"([["key"], ["fill"]])"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  sim.clock.at(sim.clock.mono() + 25min, [&] { disk.writes_fail = true; });
  sim.clock.at(sim.clock.mono() + 65min, [&] { disk.writes_fail = false; });
  const auto summary = sim.run();
  EXPECT_EQ(summary.end, "finished");
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5, 6}) expected[k] = "skipped";
  EXPECT_EQ(sim.decisions(), expected);
  sim.expectWhole();
}

TEST(Session, EndsWhenTheArchiveIsUnpluggedAndARestartRecovers) {
  Simulation sim({});
  FullDisk disk;
  sim.archive_options.files = &disk;
  sim.clock.at(sim.clock.mono() + 45min, [&] { disk.unplugged = true; });
  try {
    sim.run();
    FAIL() << "went on without a disk";
  } catch (const db::ArchiveError& error) {
    EXPECT_EQ(error.exit(), Exit::kIo) << error.what();
  }
  disk.unplugged = false;
  EXPECT_EQ(sim.run().end, "finished");
  sim.expectWhole();
}

TEST(Session, RaisesAnAlarmWhenThePictureClips) {
  Simulation sim({.duration = "1h", .exposures = R"(["1/2"])"});
  sim.run();
  std::vector<std::string> alarms;
  for (const auto& event : sim.events("alarm")) alarms.push_back(event.detail);
  EXPECT_THAT(alarms, Contains(HasSubstr("clipping cam0 key begins")));
  EXPECT_THAT(alarms, Contains(HasSubstr("saturated")));
}

TEST(Session, KeepsTheEventsOfAYearShort) {
  Simulation sim({.interval = "24h", .duration = "365d"});
  sim.run();
  EXPECT_EQ(sim.decisions().size(), 365u);
  EXPECT_LE(sim.reader().events(sim.run_id).size(), 5u);
}

}  // namespace
}  // namespace patina::testing
