// SPDX-License-Identifier: GPL-3.0-or-later
// The commit protocol when the disk fails: every call of a small run fails once, and for good.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "db/archive.h"
#include "db/errors.h"
#include "db/frame_store.h"
#include "db/journal.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

enum class Lasting { kOnce, kFromThenOn };

// A small run on a disk whose k-th call answers `error`. Answers what was acknowledged, by row id,
// and how many calls there were.
struct Outcome {
  std::map<RowId, Sha256> acked;
  std::int64_t calls = 0;
  bool failed = false;
  bool went_on = false;  // acknowledged something after a failure, with the same Archive
};

Outcome runWithFault(const std::filesystem::path& folder, std::int64_t k, int error,
                     Lasting lasting) {
  Outcome outcome;
  HookedDisk disk([&](Call call, const auto&) {
    ++outcome.calls;
    const bool now = lasting == Lasting::kOnce ? outcome.calls == k : k > 0 && outcome.calls >= k;
    if (!now) return 0;
    if (error == kShortWrite) return call == Call::kWrite ? kShortWrite : 0;
    return error;
  });
  try {
    Archive archive(optionsFor(folder, &disk));
    if (!archive.runState(kRunId)) beginRun(archive);
    for (int number = 0; number < 3; ++number) {
      try {
        for (const FrameRow& frame : capture(archive, number, static_cast<std::uint64_t>(number))) {
          outcome.acked[frame.id] = frame.sha256;
          outcome.went_on |= outcome.failed;
        }
      } catch (const ArchiveError&) {
        outcome.failed = true;
      }
    }
  } catch (const ArchiveError&) {
    outcome.failed = true;
  }
  return outcome;
}

void expectKept(const std::filesystem::path& folder, const Outcome& outcome) {
  HookedDisk disk;
  {
    const Archive archive(optionsFor(folder, &disk));
    std::map<RowId, Sha256> kept;
    if (archive.runState(kRunId))
      archive.reader().eachFrame(kRunId, [&](const ArchiveReader::CapturedFrame& f) {
        EXPECT_FALSE(f.frame.missing);
        EXPECT_NO_THROW(archive.reader().read(f.frame));
        kept[f.frame.id] = f.frame.sha256;
      });
    for (const auto& [id, hash] : outcome.acked) {
      ASSERT_TRUE(kept.contains(id)) << "acknowledged frame " << id << " is lost";
      EXPECT_EQ(kept[id], hash);
    }
  }
  Progress progress;
  for (const auto& p : verify(folder, progress).problems)
    ADD_FAILURE() << p.what << " " << p.path << ": " << p.detail;
  EXPECT_TRUE(std::filesystem::is_empty(folder / "tmp"));
}

void failEveryCall(int error, Lasting lasting) {
  const TempFolder folder = TempFolder::inMemory();
  const std::int64_t calls = runWithFault(folder / "whole", 0, 0, Lasting::kOnce).calls;
  ASSERT_GT(calls, 100);
  int failed = 0, went_on = 0;
  for (std::int64_t k = 1; k <= calls; ++k) {
    SCOPED_TRACE("call " + std::to_string(k) + " of " + std::to_string(calls));
    const auto archive = folder / std::to_string(k);
    const Outcome outcome = runWithFault(archive, k, error, lasting);
    failed += outcome.failed ? 1 : 0;
    went_on += outcome.went_on ? 1 : 0;
    expectKept(archive, outcome);
    if (::testing::Test::HasFailure()) return;
    std::filesystem::remove_all(archive);
  }
  if (error == kShortWrite)
    EXPECT_EQ(failed, 0) << "a short write is no failure";
  else
    EXPECT_GT(failed, calls / 3);
  if (error == -ENOSPC && lasting == Lasting::kOnce) {
    EXPECT_GT(went_on, 10);
  }
}

TEST(ArchiveCommit, SurvivesAnErrorOfTheDiskAtEveryCall) { failEveryCall(-EIO, Lasting::kOnce); }
TEST(ArchiveCommit, SurvivesADiskThatFailsForGoodAtEveryCall) {
  failEveryCall(-EIO, Lasting::kFromThenOn);
}
TEST(ArchiveCommit, SurvivesADiskThatIsUnpluggedAtEveryCall) {
  failEveryCall(-ENODEV, Lasting::kFromThenOn);
}
TEST(ArchiveCommit, SurvivesAFullDiskAtEveryCall) { failEveryCall(-ENOSPC, Lasting::kOnce); }
TEST(ArchiveCommit, SurvivesADiskThatStaysFullFromEveryCall) {
  failEveryCall(-ENOSPC, Lasting::kFromThenOn);
}
TEST(ArchiveCommit, SurvivesAShortWriteAtEveryCall) {
  failEveryCall(kShortWrite, Lasting::kOnce);
  failEveryCall(kShortWrite, Lasting::kFromThenOn);
}

class ArchiveCommitTest : public ::testing::Test {
 protected:
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path path_ = folder_ / "archive";
  std::function<int(Call, const std::filesystem::path&)> hook_;
  HookedDisk disk_{[this](Call call, const auto& path) { return hook_ ? hook_(call, path) : 0; }};
  Progress progress_;
};

TEST_F(ArchiveCommitTest, AFullDiskAcknowledgesNothingAndGoesOnWhenThereIsRoom) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  capture(archive, 0, 1);
  StepRow step = stepRow(1);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  const Bytes bytes = frameBytes(2);
  const auto frames = std::vector{pendingFrame(shot, bytes)};

  // Full for frames, while the small rows that say so still fit.
  hook_ = [](Call call, const auto& path) {
    const bool frame = path.parent_path().filename() == "tmp" && path.extension() == ".jpg";
    return call == Call::kWrite && frame ? -ENOSPC : 0;
  };
  EXPECT_THROW(archive.acknowledge(shot, frames, {}, at(0)), DiskFull);
  EXPECT_TRUE(std::filesystem::is_empty(path_ / "tmp"));
  archive.addEvent({0, kRunId, at(600), "disk", "full"});
  hook_ = {};
  EXPECT_THAT(archive.acknowledge(shot, frames, {}, at(0)), SizeIs(1));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveCommitTest, ArmingSyncsTheJournalAndNothingElse) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  capture(archive, 0, 1);
  StepRow step = stepRow(1);
  step.id = archive.beginStep(step);
  std::vector<std::string> synced;
  hook_ = [&](Call call, const auto& path) {
    if (call == Call::kSync) synced.push_back(path.filename());
    return 0;
  };
  archive.armShot(shotRow(step));
  hook_ = {};
  EXPECT_THAT(synced, ElementsAre(std::string(kRunId) + ".jsonl"));
}

TEST_F(ArchiveCommitTest, WhatWasArmedSurvivesACommitThatFails) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  StepRow step = stepRow(0);
  step.id = archive.beginStep(step);
  ShotRow first = shotRow(step), second = shotRow(step);
  second.exposure_index = 1;
  first.id = archive.armShot(first);
  second.id = archive.armShot(second);
  hook_ = [&](Call call, const auto& path) {
    return call == Call::kSync && path.extension() == ".sqlite-wal" ? -ENOSPC : 0;
  };
  EXPECT_THROW(archive.failShot(first, "no light"), DiskFull);
  hook_ = {};
  archive.failShot(first, "no light");
  const Bytes bytes = frameBytes(3);
  archive.acknowledge(second, std::vector{pendingFrame(second, bytes)}, {}, at(0));
  EXPECT_THAT(archive.reader().shotsOfStep(step.id), SizeIs(2));
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveCommitTest, AShotIsArmedOnce) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  StepRow step = stepRow(0);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  EXPECT_THROW(archive.armShot(shot), ArchiveError) << "while its row is in no table yet";
  archive.failShot(shot, "no light");
  EXPECT_THROW(archive.armShot(shot), ArchiveError) << "when the table has it";
  ++shot.attempt;
  EXPECT_NO_THROW(archive.armShot(shot));
}

TEST_F(ArchiveCommitTest, TheReserveLetsAFullDiskNoteItsEnd) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  ASSERT_TRUE(std::filesystem::exists(path_ / "reserve"));
  hook_ = [this](Call call, const auto&) {
    return call == Call::kWrite && std::filesystem::exists(path_ / "reserve") ? -ENOSPC : 0;
  };
  archive.setRunState(kRunId, "stopped");
  EXPECT_FALSE(std::filesystem::exists(path_ / "reserve"));
  EXPECT_EQ(archive.reader().findRun(kRunId).state, "stopped");
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveCommitTest, AFrameWhoseSyncFailsIsWrittenAnewOnce) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  std::vector<std::filesystem::path> synced;
  const auto fail_first = [&](std::size_t failures) {
    return [&synced, failures](Call call, const std::filesystem::path& path) {
      if (call != Call::kSync || path.extension() != ".jpg") return 0;
      synced.push_back(path);
      return synced.size() <= failures ? -EIO : 0;
    };
  };
  hook_ = fail_first(1);
  EXPECT_THAT(capture(archive, 0, 1), SizeIs(1));
  ASSERT_THAT(synced, SizeIs(2));
  EXPECT_NE(synced[0], synced[1]) << "the same file was synced again";

  synced.clear();
  hook_ = fail_first(2);
  try {
    capture(archive, 1, 2);
    FAIL() << "acknowledged without a sync";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kIo);
  }
  EXPECT_THAT(synced, SizeIs(2));
  hook_ = {};
}

TEST_F(ArchiveCommitTest, AfterAFailedSyncOfTheJournalNothingIsPromised) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  capture(archive, 0, 1);
  hook_ = [](Call call, const auto& path) {
    return call == Call::kSync && path.extension() == ".jsonl" ? -EIO : 0;
  };
  EXPECT_THROW(capture(archive, 1, 2), ArchiveError);
  hook_ = {};
  EXPECT_THROW(capture(archive, 2, 3), ArchiveError) << "went on with a journal it cannot trust";
}

TEST_F(ArchiveCommitTest, StepsPassTheirPointsInOrder) {
  ArchiveOptions options = optionsFor(path_, &disk_);
  std::string passed;
  options.at_point = [&](CommitPoint p) { passed += std::string(name(p)) + " "; };
  Archive archive(options);
  beginRun(archive);
  capture(archive, 0, 1);
  EXPECT_EQ(passed,
            "shot_armed tmp_written tmp_synced renamed folder_synced journal_synced committed ");
}

TEST_F(ArchiveCommitTest, PutsTheBytesOnDiskBeforeTheirNameAndTheJournalBeforeTheRow) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  capture(archive, 0, 1);
  StepRow step = stepRow(1);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  std::string order;
  hook_ = [&](Call call, const std::filesystem::path& path) {
    if (call == Call::kSync && path.extension() == ".jpg") order += "file ";
    if (call == Call::kRename) order += "rename ";
    if (call == Call::kSyncFolder && path.parent_path().filename() == "frames") order += "folder ";
    if (call == Call::kSync && path.extension() == ".jsonl") order += "journal ";
    if (call == Call::kSync && path.string().ends_with("-wal")) order += "commit ";
    return 0;
  };
  const Bytes bytes = frameBytes(2);
  archive.acknowledge(shot, std::vector{pendingFrame(shot, bytes)}, {}, at(0));
  hook_ = {};
  EXPECT_EQ(order, "file rename folder journal commit ");
}

// A shot of two files whose second finds no room; what the disk is then told of the first and of
// the journal, in order. A disk that cannot sync folders leaves open what a power cut brings back.
class ArchiveUndoTest : public ArchiveCommitTest {
 protected:
  void failSecondRename(Archive& archive, bool folders_sync) {
    beginRun(archive);
    StepRow step = stepRow(0);
    step.id = archive.beginStep(step);
    ShotRow shot = shotRow(step);
    shot.id = archive.armShot(shot);
    int renames = 0;
    hook_ = [&, folders_sync](Call call, const std::filesystem::path& path) {
      note(call, path);
      if (call == Call::kRename) return ++renames == 2 ? -ENOSPC : 0;
      return call == Call::kSyncFolder && path == first_.parent_path() && !folders_sync ? -EIO : 0;
    };
    const std::vector frames{pendingFrame(shot, bytes_[0], 0), pendingFrame(shot, bytes_[1], 1)};
    EXPECT_THROW(archive.acknowledge(shot, frames, {}, at(0)), DiskFull);
    hook_ = {};
  }
  void note(Call call, const std::filesystem::path& path) {
    if (call == Call::kRemove && path == first_) order_ += "remove ";
    if (call == Call::kSyncFolder && path == first_.parent_path()) order_ += "folder ";
    if (call == Call::kTruncate && path == journalPath(path_, kRunId)) order_ += "cut ";
  }
  const Bytes bytes_[2] = {frameBytes(1), frameBytes(2)};
  const std::filesystem::path first_ = path_ / framePath(sha256(bytes_[0]), "jpg");
  std::string order_;
};

TEST_F(ArchiveUndoTest, AFrameIsTakenAwayForGoodBeforeItsLines) {
  Archive archive(optionsFor(path_, &disk_));
  failSecondRename(archive, true);
  EXPECT_EQ(order_, "remove folder cut ");
  EXPECT_THAT(capture(archive, 1, 3), SizeIs(1)) << "there is room again";
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveUndoTest, AFrameThatMayComeBackKeepsItsLinesForTheNextStart) {
  {
    Archive archive(optionsFor(path_, &disk_));
    failSecondRename(archive, false);
    EXPECT_EQ(order_, "remove folder ");
    EXPECT_THROW(capture(archive, 1, 3), ArchiveError) << "wrote after lines that nobody judged";
  }
  order_.clear();
  hook_ = [this](Call call, const auto& path) {
    note(call, path);
    return 0;
  };
  const Archive archive(optionsFor(path_, &disk_));
  EXPECT_EQ(order_, "folder cut ");
  EXPECT_THAT(verify(path_, progress_).problems, IsEmpty());
}

TEST_F(ArchiveCommitTest, AFailedShotKeepsItsReason) {
  Archive archive(optionsFor(path_, &disk_));
  beginRun(archive);
  StepRow step = stepRow(0);
  step.id = archive.beginStep(step);
  ShotRow shot = shotRow(step);
  shot.id = archive.armShot(shot);
  archive.failShot(shot, "timeout");
  EXPECT_EQ(archive.reader().shotsOfStep(step.id)[0].state, ShotState::kFailed);
  EXPECT_THAT(archive.reader().events(kRunId)[0].detail, HasSubstr("timeout"));
  EXPECT_THROW(archive.acknowledge(shot, {}, {}, at(0)), ArchiveError);
}

}  // namespace
}  // namespace patina::db::testing
