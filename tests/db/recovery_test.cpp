// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/recovery.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "tests/db/dump.h"
#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class RecoveryTest : public ::testing::Test {
 protected:
  RecoveryTest() {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    capture(archive, 0, 1);
  }
  // What a process leaves that dies between two points: `leave` changes the files as it would have.
  RecoveryReport reopen() {
    const Archive archive(optionsFor(path_));
    return archive.recovery();
  }
  std::vector<std::string> problems() {
    std::vector<std::string> lines;
    for (const auto& p : verify(path_, progress_).problems)
      lines.push_back(p.what + " " + p.path + " " + p.detail);
    return lines;
  }
  fs::path journal() const { return journalPath(path_, kRunId); }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
  Progress progress_;
};

TEST_F(RecoveryTest, ACleanArchiveIsLeftAsItIs) {
  const auto before = dumpOf(path_);
  const RecoveryReport report = reopen();
  EXPECT_EQ(report.rows_from_journal + report.frames_adopted + report.frames_quarantined +
                report.shots_lost + report.frames_missing,
            0);
  EXPECT_EQ(dumpOf(path_), before);
}

TEST_F(RecoveryTest, UnfinishedWritesAreSwept) {
  writeFile(path_ / "tmp" / "1.jpg", "half");
  EXPECT_EQ(reopen().tmp_swept, 1);
  EXPECT_TRUE(fs::is_empty(path_ / "tmp"));
}

TEST_F(RecoveryTest, RowsThatOnlyTheJournalHasComeBack) {
  fs::copy_file(path_ / "catalog.sqlite", folder_ / "older.sqlite");
  {
    Archive archive(optionsFor(path_));
    capture(archive, 1, 2);
    capture(archive, 2, 3);
  }
  const auto whole = dumpOf(path_);
  fs::copy_file(folder_ / "older.sqlite", path_ / "catalog.sqlite",
                fs::copy_options::overwrite_existing);
  const RecoveryReport report = reopen();
  EXPECT_EQ(report.frames_adopted, 2);
  EXPECT_EQ(dumpOf(path_), whole);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RecoveryTest, ATornTailIsCutOff) {
  const std::string before = readFile(journal());
  writeFile(journal(), before + "{\"row\":\"event\",\"id\":99,");
  reopen();
  EXPECT_EQ(readFile(journal()), before);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RecoveryTest, LinesWhoseFramesNeverFoundTheirPlaceAreDropped) {
  fs::copy_file(path_ / "catalog.sqlite", folder_ / "older.sqlite");
  fs::path frame;
  {
    Archive archive(optionsFor(path_));
    frame = archive.reader().pathOf(capture(archive, 1, 2)[0]);
  }
  fs::copy_file(folder_ / "older.sqlite", path_ / "catalog.sqlite",
                fs::copy_options::overwrite_existing);
  fs::remove(frame);
  const RecoveryReport report = reopen();
  EXPECT_EQ(report.frames_adopted, 0);
  EXPECT_EQ(report.shots_lost, 1) << "it was armed and nothing came";
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RecoveryTest, OfAShotThatIsDroppedNoFileStaysWhateverIsNewer) {
  fs::copy_file(path_ / "catalog.sqlite", folder_ / "older.sqlite");
  std::vector<FrameRow> rows;
  {
    Archive archive(optionsFor(path_));
    StepRow step = stepRow(1);
    step.id = archive.beginStep(step);
    ShotRow shot = shotRow(step);
    shot.id = archive.armShot(shot);
    const Bytes first = frameBytes(2), second = frameBytes(3);
    rows = archive.acknowledge(
        shot, std::vector{pendingFrame(shot, first, 0), pendingFrame(shot, second, 1)}, {},
        at(600));
  }
  fs::copy_file(folder_ / "older.sqlite", path_ / "catalog.sqlite",
                fs::copy_options::overwrite_existing);
  fs::remove(path_ / framePath(rows[1].sha256, rows[1].ext));
  // A product's line, say, came after the frames.
  const auto placed = path_ / framePath(rows[0].sha256, rows[0].ext);
  fs::last_write_time(placed.parent_path(), fs::last_write_time(journal()) - std::chrono::hours(1));
  EXPECT_EQ(reopen().frames_quarantined, 1);
  EXPECT_FALSE(fs::exists(placed));
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RecoveryTest, ARowWhoseFileIsGoneIsMarkedOnceAndFoundAgain) {
  const ArchiveReader reader(path_);
  const FrameRow frame = *reader.newestFrame(kRunId);
  const std::string bytes = readFile(reader.pathOf(frame));
  fs::remove(reader.pathOf(frame));
  EXPECT_EQ(reopen().frames_missing, 1);
  EXPECT_EQ(reopen().frames_missing, 1);
  EXPECT_TRUE(reader.newestFrame(kRunId)->missing);
  ASSERT_THAT(reader.events(kRunId), SizeIs(1)) << "said once";
  EXPECT_EQ(reader.events(kRunId)[0].kind, "frame_missing");
  writeFile(reader.pathOf(frame), bytes);
  EXPECT_EQ(reopen().frames_missing, 0);
  EXPECT_FALSE(reader.newestFrame(kRunId)->missing);
  EXPECT_THAT(problems(), IsEmpty());
}

TEST_F(RecoveryTest, SurvivesItsOwnDeathAtEveryCall) {
  // A frame without a row, a torn tail, an armed shot and a swept file, all at once.
  {
    Archive archive(optionsFor(path_));
    StepRow step = stepRow(1);
    step.id = archive.beginStep(step);
    archive.armShot(shotRow(step));
  }
  writeFile(journal(), readFile(journal()) + "{torn");
  const Bytes orphan = frameBytes(99);
  const auto orphan_path = path_ / framePath(sha256(orphan), "jpg");
  fs::create_directories(orphan_path.parent_path());
  writeFileAtomically(orphan_path, orphan);
  writeFile(path_ / "tmp" / "1.jpg", "half");
  const auto snapshot = folder_ / "snapshot";
  // Times matter: the orphan is younger than the journals.
  const auto copy = [](const fs::path& from, const fs::path& to) {
    fs::remove_all(to);
    fs::copy(from, to, fs::copy_options::recursive);
    for (const auto& entry : fs::recursive_directory_iterator(from))
      fs::last_write_time(to / fs::relative(entry.path(), from), fs::last_write_time(entry.path()));
  };
  copy(path_, snapshot);
  const auto recoverOn = [&](std::int64_t fail_at) {
    std::int64_t calls = 0;
    HookedDisk disk([&](Call, const auto&) { return ++calls == fail_at ? -EIO : 0; });
    try {
      Archive archive(optionsFor(path_, &disk));
    } catch (const ArchiveError&) {
      // Died here; the next start begins where it left the files.
    }
    return calls;
  };
  const std::int64_t calls = recoverOn(0);
  for (std::int64_t k = 1; k <= calls; ++k) {
    SCOPED_TRACE("call " + std::to_string(k));
    copy(snapshot, path_);
    recoverOn(k);
    reopen();
    ASSERT_THAT(problems(), IsEmpty());
    ASSERT_EQ(reopen().shots_lost, 0);
    ASSERT_TRUE(fs::exists(path_ / "quarantine" / (sha256(orphan).hex() + ".jpg")));
  }
}

}  // namespace
}  // namespace patina::db::testing
