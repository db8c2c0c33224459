// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive_state.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class ArchiveStateTest : public ::testing::Test {
 protected:
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path path_ = folder_ / "deep" / "below" / "archive";
  Progress progress_;
};

TEST_F(ArchiveStateTest, MakesItsFolders) {
  Archive archive(optionsFor(path_));
  for (const char* name : {"tmp", "journal", "frames", "products"})
    EXPECT_TRUE(std::filesystem::is_directory(path_ / name)) << name;
  EXPECT_EQ(std::filesystem::file_size(path_ / "reserve"), 1u << 20);
}

TEST_F(ArchiveStateTest, ARunsIdMustBeAFileName) {
  Archive archive(optionsFor(path_));
  for (const char* bad : {"", "..", "a/b", "_archive", ".hidden", "a b"})
    EXPECT_THROW(beginRun(archive, bad), ArchiveError) << bad;
}

TEST_F(ArchiveStateTest, AStepIsBegunOnce) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  capture(archive, 0, 1);
  capture(archive, 5, 2);
  EXPECT_THROW(archive.beginStep(stepRow(0)), ArchiveError);
  EXPECT_THROW(archive.beginStep(stepRow(5)), ArchiveError);
  EXPECT_NO_THROW(capture(archive, 3, 3)) << "a gap may be filled";
}

TEST_F(ArchiveStateTest, APendingStepWaitsForTheFirstRowOfItsRun) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  archive.beginStep(stepRow(0));
  EXPECT_THAT(archive.reader().steps(kRunId), IsEmpty());
  archive.addEvent({0, kRunId, at(0), "note", ""});
  EXPECT_THAT(archive.reader().steps(kRunId, Decision::kPending), SizeIs(1));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveStateTest, AManualShotHasAStepWithoutANumber) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  for (int i = 0; i < 2; ++i) {
    StepRow manual = stepRow(0);
    manual.number.reset();
    manual.id = archive.beginStep(manual);
    ShotRow shot = shotRow(manual);
    shot.id = archive.armShot(shot);
    manual.decision = Decision::kCaptured;
    const Bytes bytes = frameBytes(static_cast<std::uint64_t>(i));
    archive.acknowledge(shot, std::vector{pendingFrame(shot, bytes)}, {}, at(0), &manual);
  }
  EXPECT_THAT(archive.reader().steps(kRunId), SizeIs(2));
  EXPECT_FALSE(archive.runState(kRunId)->last_number);
}

TEST_F(ArchiveStateTest, ARawAndItsJpegAreOneAcknowledgement) {
  Archive archive(optionsFor(path_));
  beginRun(archive);
  StepRow step = stepRow(0);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  const Bytes raw = frameBytes(1, 9000), jpeg = frameBytes(2);
  auto frames = std::vector{pendingFrame(shot, raw, 0), pendingFrame(shot, jpeg, 1)};
  frames[0].ext = "nef";
  EXPECT_THAT(archive.acknowledge(shot, frames, {}, at(0)), SizeIs(2));
  const auto kept = archive.reader().framesOfStep(step.id);
  ASSERT_THAT(kept, SizeIs(2));
  EXPECT_EQ(archive.reader().read(kept[0]), raw);
  EXPECT_EQ(archive.reader().read(kept[1]), jpeg);
}

TEST_F(ArchiveStateTest, UnpluggedInMidRunNothingMoreIsPromised) {
  bool gone = false;
  HookedDisk disk([&](Call, const auto&) { return gone ? -ENODEV : 0; });
  Archive archive(optionsFor(path_, &disk));
  beginRun(archive);
  capture(archive, 0, 1);
  gone = true;
  EXPECT_THROW(capture(archive, 1, 2), ArchiveError);
  EXPECT_THROW(capture(archive, 2, 3), ArchiveError);
}

}  // namespace
}  // namespace patina::db::testing
