// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ArchiveTest : public ::testing::Test {
 protected:
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path path_ = folder_ / "archive";
  Progress progress_;
};

TEST_F(ArchiveTest, KeepsWhatWasAcknowledgedUnderItsHash) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  const auto acked = capture(archive, 0, 1);
  ASSERT_THAT(acked, SizeIs(1));
  const Bytes bytes = frameBytes(1);
  EXPECT_EQ(acked[0].sha256, sha256(bytes));
  const std::string hex = acked[0].sha256.hex();
  const auto file = path_ / "frames" / hex.substr(0, 2) / (hex.substr(2) + ".jpg");
  EXPECT_EQ(readFile(file), bytes);
  EXPECT_THAT(std::filesystem::directory_iterator(path_ / "tmp"),
              ::testing::Eq(std::filesystem::directory_iterator()));

  const ArchiveReader reader(path_);
  const auto newest = reader.newestFrame(kRunId);
  ASSERT_TRUE(newest);
  EXPECT_EQ(newest->id, acked[0].id);
  EXPECT_EQ(reader.read(*newest), bytes);
  EXPECT_EQ(reader.pathOf(*newest), file);
}

TEST_F(ArchiveTest, RowsComeBackAsTheyWereGiven) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  capture(archive, 0, 1);
  const RunRow run = archive.reader().findRun("latest");
  EXPECT_EQ(run.specimen, "banana");
  EXPECT_EQ(run.rig, "bench");
  EXPECT_EQ(run.seed, 0xfedcba9876543210);
  EXPECT_EQ(run.interval, std::chrono::minutes(10));
  const auto step = archive.reader().step(kRunId, 0);
  ASSERT_TRUE(step);
  EXPECT_EQ(step->decision, Decision::kCaptured);
  const auto shots = archive.reader().shotsOfStep(step->id);
  ASSERT_THAT(shots, SizeIs(1));
  EXPECT_EQ(shots[0].state, ShotState::kCaptured);
  EXPECT_EQ(shots[0].exposure, std::chrono::milliseconds(20));
  const auto checks = archive.reader().lightChecksOfShot(shots[0].id);
  ASSERT_THAT(checks, SizeIs(3));
  EXPECT_EQ(checks[0].baseline, 1.0 / 3);
  EXPECT_THAT(archive.reader().framesOfStep(step->id), SizeIs(1));
  EXPECT_THAT(archive.reader().framesBetween(kRunId, at(0), at(1)), SizeIs(1));
  EXPECT_THAT(archive.reader().framesBetween(kRunId, at(1), at(2)), IsEmpty());
}

TEST_F(ArchiveTest, ASecondOwnerIsToldWhoTheFirstIs) {
  const Archive archive(optionsFor(path_));
  try {
    const Archive second(optionsFor(path_));
    FAIL() << "two owners";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kTemporary);
    EXPECT_THAT(e.what(), HasSubstr("'a test' (pid " + std::to_string(::getpid())));
    EXPECT_THAT(e.what(), HasSubstr("since 20"));
  }
}

TEST_F(ArchiveTest, AShotIsAcknowledgedOnlyOnce) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  StepRow step = stepRow(0);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  const Bytes bytes = frameBytes(1);
  const auto frames = std::vector{pendingFrame(shot, bytes)};
  archive.acknowledge(shot, frames, {}, at(0));
  EXPECT_THROW(archive.acknowledge(shot, frames, {}, at(0)), ArchiveError);
  EXPECT_THAT(archive.reader().framesOfStep(step.id), SizeIs(1));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveTest, EqualBytesAreOneFileAndTwoRows) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  const auto first = capture(archive, 0, 7);
  const auto second = capture(archive, 1, 7);
  EXPECT_EQ(first[0].sha256, second[0].sha256);
  EXPECT_NE(first[0].id, second[0].id);
  const auto report = verify(path_, progress_);
  EXPECT_EQ(report.frames, 2);
  EXPECT_THAT(report.problems, IsEmpty());
}

TEST_F(ArchiveTest, APendingStepLeavesNoTraceBeforeItsFirstShot) {
  {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    archive.beginStep(stepRow(0));
  }
  Archive archive(optionsFor(path_));
  const auto state = archive.runState(kRunId);
  ASSERT_TRUE(state);
  EXPECT_FALSE(state->last_number);
  EXPECT_FALSE(state->unfinished);
}

TEST_F(ArchiveTest, ARestartedSessionFindsTheStepItDiedIn) {
  {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    capture(archive, 0, 1);
    StepRow step = stepRow(1);
    step.id = archive.beginStep(step);
    archive.armShot(shotRow(step));
  }
  Archive archive(optionsFor(path_));
  EXPECT_EQ(archive.recovery().shots_lost, 1);
  const auto state = archive.runState(kRunId);
  ASSERT_TRUE(state && state->unfinished && state->last_number);
  EXPECT_EQ(*state->last_number, 1);
  EXPECT_EQ(state->unfinished->number, 1);
  const auto shots = archive.reader().shotsOfStep(state->unfinished->id);
  ASSERT_THAT(shots, SizeIs(1));
  EXPECT_EQ(shots[0].state, ShotState::kLost);
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveTest, EveryKindOfRowIsFoundAgainByItsRun) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  archive.addDevice({"lux0", "sensor", "twin", "L1", "lux meter"});
  ReadingRow reading{0, kRunId, "lux0", "illuminance", "lx", {}, 512.25, at(3), "ok"};
  archive.addReading(reading);
  archive.addEvent({0, kRunId, at(4), "alarm", "quote \" slash \\ tab \t \xff end"});
  archive.addEvent({0, {}, at(5), "disk", "of no run"});
  archive.setRunState(kRunId, "finished");
  std::vector<StepRow> gap;
  for (int number = 3; number < 8; ++number) {
    gap.push_back(stepRow(number));
    gap.back().decision = Decision::kMissed;
  }
  archive.addSteps(gap);
  StepRow held = stepRow(8);
  held.id = archive.beginStep(held);
  held.decision = Decision::kHeld;
  held.reason = "light key+0.051";
  archive.finishStep(held);

  const ArchiveReader& r = archive.reader();
  ASSERT_THAT(r.readings(kRunId), SizeIs(1));
  EXPECT_EQ(r.readings(kRunId)[0].value, 512.25);
  ASSERT_THAT(r.events(kRunId), SizeIs(1));
  EXPECT_EQ(r.events(kRunId)[0].detail, "quote \" slash \\ tab \t \xEF\xBF\xBD end");
  EXPECT_THAT(r.events(""), SizeIs(1));
  EXPECT_EQ(r.findRun("2024").state, "finished");
  EXPECT_THAT(r.steps(kRunId, Decision::kMissed), SizeIs(5));
  EXPECT_THAT(r.steps(kRunId), SizeIs(6));
  ASSERT_TRUE(r.step(kRunId, 8));
  EXPECT_EQ(r.step(kRunId, 8)->reason, "light key+0.051");
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveTest, LatestIsTheRunAddedLastHoweverOldItsPicturesAre) {
  {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    RunRow older = archive.reader().findRun(kRunId);
    older.id = "19990101T000000Z-older";
    older.t0_utc -= std::chrono::hours(24 * 365);
    archive.beginRun(older, {0, "older", "", "", ""});
    EXPECT_EQ(archive.reader().findRun("latest").id, older.id);
  }
  rebuild(path_, progress_);
  EXPECT_EQ(ArchiveReader(path_).findRun("latest").id, "19990101T000000Z-older");
}

TEST_F(ArchiveTest, QuarantinedBytesKeepTheirNameAndReason) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  const Bytes bytes = frameBytes(9);
  archive.quarantine(bytes, "jpg", {0, kRunId, at(0), "quarantine", "truncated"});
  EXPECT_EQ(readFile(path_ / "quarantine" / (sha256(bytes).hex() + ".jpg")), bytes);
  EXPECT_THAT(archive.reader().events(kRunId), SizeIs(1));
  EXPECT_THROW(archive.quarantine(bytes, "../x", {0, kRunId, at(0), "quarantine", ""}),
               ArchiveError);
}

TEST_F(ArchiveTest, AMissingRunIsAnsweredWithTheChoices) {
  Archive archive(optionsFor(path_));
  EXPECT_THROW(archive.reader().findRun("latest"), ArchiveError);
  beginRun(archive);
  try {
    archive.reader().findRun("2099");
    FAIL() << "found a run of 2099";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kUsage);
    EXPECT_THAT(e.what(), HasSubstr(kRunId));
  }
}

}  // namespace
}  // namespace patina::db::testing
