// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/archive.h"
#include "db/database.h"
#include "db/journal.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class VerifyTest : public ::testing::Test {
 protected:
  VerifyTest() {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    for (int number = 0; number < 4; ++number)
      capture(archive, number, static_cast<std::uint64_t>(number));
    frame_ = archive.reader().pathOf(*archive.reader().newestFrame(kRunId));
  }
  std::vector<std::string> found() {
    std::vector<std::string> what;
    for (const auto& p : verify(path_, progress_).problems) what.push_back(p.what);
    return what;
  }
  void change(const std::string& sql) {
    Database database(path_ / "catalog.sqlite", Database::Access::kWrite, realFileOps());
    database.run(sql);
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive", frame_;
  Progress progress_;
};

TEST_F(VerifyTest, CountsWhatIsThere) {
  const VerifyReport report = verify(path_, progress_);
  EXPECT_EQ(report.frames, 4);
  EXPECT_EQ(report.bytes, 4 * 3000);
  EXPECT_GT(report.rows, 4 * 6);
  EXPECT_THAT(report.problems, IsEmpty());
}

TEST_F(VerifyTest, FindsAnyFlippedBitOfAFrame) {
  const std::string bytes = readFile(frame_);
  for (std::size_t at = 0; at < bytes.size(); at += 499) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    writeFile(frame_, damaged);
    EXPECT_THAT(found(), ElementsAre("hash"));
  }
}

TEST_F(VerifyTest, FindsATruncatedAndAMissingFrame) {
  fs::resize_file(frame_, 2999);
  EXPECT_THAT(found(), ElementsAre("size"));
  fs::remove(frame_);
  EXPECT_THAT(found(), ElementsAre("missing"));
}

TEST_F(VerifyTest, FindsAFileWithoutARow) {
  writeFile(frame_.parent_path() / "stranger.txt", "hello");
  EXPECT_THAT(found(), ElementsAre("orphan"));
}

TEST_F(VerifyTest, FindsARowThatWasChangedOrRemovedBehindOurBack) {
  change("UPDATE light_check SET gain = 2 WHERE id = 1");
  EXPECT_THAT(found(), ElementsAre("row", "row")) << "once from each side";
  change("UPDATE light_check SET gain = 1 WHERE id = 1; DELETE FROM light_check WHERE id = 2");
  EXPECT_THAT(found(), ElementsAre("row"));
}

TEST_F(VerifyTest, FindsARowThatTheJournalDoesNotKnow) {
  change("INSERT INTO event VALUES(99, NULL, 0, 'by hand', '')");
  EXPECT_THAT(found(), ElementsAre("row"));
}

TEST_F(VerifyTest, FindsADamagedLineOfTheJournal) {
  const auto journal = journalPath(path_, kRunId);
  std::string text = readFile(journal);
  text[text.size() / 2] = static_cast<char>(text[text.size() / 2] ^ 1);
  writeFile(journal, text);
  EXPECT_THAT(found(), ::testing::Contains("journal"));
}

TEST_F(VerifyTest, WorksBesideACapturingProcess) {
  Archive archive(optionsFor(path_));
  capture(archive, 4, 44);
  StepRow step = stepRow(5);
  step.id = archive.beginStep(step);
  archive.armShot(shotRow(step));
  EXPECT_THAT(found(), IsEmpty());
}

TEST_F(VerifyTest, StopsWhenAsked) {
  progress_.askToStop();
  EXPECT_THROW(verify(path_, progress_), Stopped);
}

}  // namespace
}  // namespace patina::db::testing
