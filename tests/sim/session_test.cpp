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

TEST(Session, KnowsTheLightItHadBeforeARestart) {
  Simulation sim({.faults = "[[fault]]\nat = \"65min\"\ndevice = \"key\"\nkind = \"lamp_step\"\n"
                            "amount = -0.3\n"});
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 85min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  sim.run();
  EXPECT_EQ(sim.decisions()[6], "captured");
  EXPECT_EQ(sim.decisions()[7], "held");
  EXPECT_EQ(sim.decisions()[11], "held");
  sim.expectWhole();
}

TEST(Session, AsksThePictureAboutItsLightFromTheFirstShotAfterARestart) {
  Simulation sim({.duration = "3h"});
  std::stop_source stop;
  sim.clock.at(sim.clock.mono() + 105min, [&] { stop.request_stop(); });
  sim.run([&](capture::SessionHooks& hooks) { hooks.stop = stop.get_token(); });
  sim.run();
  const auto step = sim.reader().step(sim.run_id, 11);
  ASSERT_TRUE(step);
  int votes = 0;
  for (const db::ShotRow& shot : sim.reader().shotsOfStep(step->id))
    for (const db::LightCheckRow& check : sim.reader().lightChecksOfShot(shot.id))
      votes += check.source == "content:cam0" ? 1 : 0;
  EXPECT_EQ(votes, 1);
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

TEST(Session, AnAbortWaitsForNoLightAndNoPicture) {
  Simulation sim({.light_check = "settle = \"5min\"\n"});
  std::stop_source stop, abort;
  sim.clock.at(sim.clock.mono() + 22min, [&] {
    abort.request_stop();
    stop.request_stop();
  });
  const auto summary = sim.run([&](capture::SessionHooks& hooks) {
    hooks.stop = stop.get_token();
    hooks.abort = abort.get_token();
  });
  EXPECT_EQ(summary.end, "aborted");
  EXPECT_EQ(sim.reader().runs().back().state, "aborted");
  const auto step = sim.reader().step(sim.run_id, 2);
  EXPECT_EQ(step->decision, db::Decision::kMissed);
  EXPECT_EQ(step->reason, "aborted by the operator");
  EXPECT_EQ(step->shots_captured, 0);
  EXPECT_EQ(summary.last.now_utc - sim.t0, 22min);
}

TEST(Session, TellsOfEveryStepShotVerdictAndCamera) {
  Simulation sim({.duration = "1h", .lights = R"([["key"], ["fill"]])"});
  int steps = 0, shots = 0, verdicts = 0, alive = 0;
  capture::SessionStatus last;
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.on_step = [&](const db::StepRow& row) {
      ++steps;
      EXPECT_EQ(row.decision, db::Decision::kCaptured);
    };
    hooks.on_shot = [&](const db::ShotRow& row) {
      ++shots;
      EXPECT_EQ(row.state, db::ShotState::kCaptured);
    };
    hooks.on_light = [&](std::span<const db::LightCheckRow> rows) {
      verdicts += static_cast<int>(rows.size());
    };
    hooks.on_alive = [&] { ++alive; };
    hooks.on_status = [&](const capture::SessionStatus& status) { last = status; };
  });
  EXPECT_EQ(steps, 6);
  EXPECT_EQ(shots, 12);
  EXPECT_EQ(verdicts, static_cast<int>(sim.reader().lightChecks(sim.run_id).size()));
  EXPECT_GT(alive, 6 * 40);  // every 15 s of ten minutes
  ASSERT_EQ(last.cameras.size(), 1u);
  EXPECT_TRUE(last.cameras[0].up);
}

TEST(Session, StopsCleanlyBeforeTheDiskIsFullAndGoesOnWhenThereIsRoom) {
  Simulation sim({.plan = "[disk]\nreserve = \"1GB\"\n"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  sim.clock.at(sim.clock.mono() + 25min, [&] { disk.free_bytes = 1'000'000'000; });
  sim.clock.at(sim.clock.mono() + 65min, [&] { disk.free_bytes = 5'000'000'000; });
  std::vector<bool> forecast;
  const auto summary = sim.run([&](capture::SessionHooks& hooks) {
    hooks.on_status = [&](const capture::SessionStatus& status) {
      forecast.push_back(status.disk_full_utc.has_value());
    };
  });
  EXPECT_EQ(summary.end, "finished");
  std::vector<std::string> expected = twelve("captured");
  for (std::size_t k : {3, 4, 5, 6}) expected[k] = "skipped";
  EXPECT_EQ(sim.decisions(), expected);
  EXPECT_FALSE(forecast.front());
  EXPECT_EQ(std::count(forecast.begin(), forecast.end(), true), 4) << "while it was full";
  EXPECT_FALSE(forecast.back());
  EXPECT_TRUE(std::filesystem::exists(sim.archive_options.folder / "reserve"));
  EXPECT_EQ(sim.reader().step(sim.run_id, 4)->reason, "disk");
  EXPECT_EQ(sim.events("disk").size(), 2u);
  sim.expectWhole();
}

TEST(Session, WarnsDaysAheadThatTheDiskWillBeFullBeforeTheRunIsOver) {
  Simulation sim({.interval = "6h", .duration = "30d", .plan = "[disk]\nreserve = \"1GB\"\n"});
  FullDisk disk;
  sim.archive_options.files = &disk;
  constexpr std::uint64_t kBytesAShot = 64 * 48 + 1024;  // as the twin's camera says
  disk.free_bytes = 1'000'000'000 + 60 * kBytesAShot;
  sim.clock.at(sim.clock.mono() + 50h, [&] { disk.free_bytes = 5'000'000'000; });
  std::vector<std::string> told;
  sim.run([&](capture::SessionHooks& hooks) {
    hooks.on_alert = [&](const capture::AlertNews& news) {
      if (news.kind == capture::AlertKind::kDiskFilling &&
          news.event != capture::AlertEvent::kReminder)
        told.push_back(std::string(name(news.event)) + " " + news.detail);
    };
  });
  ASSERT_EQ(told.size(), 2u);
  EXPECT_THAT(told[0], HasSubstr("begins full in 15 days, before the run is over"));
  EXPECT_THAT(told[1], HasSubstr("over"));
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

TEST(Session, KeepsTheEventsOfAYearShort) {
  Simulation sim({.interval = "24h", .duration = "365d"});
  sim.run();
  EXPECT_EQ(sim.decisions().size(), 365u);
  EXPECT_LE(sim.reader().events(sim.run_id).size(), 5u);
}

}  // namespace
}  // namespace patina::testing
