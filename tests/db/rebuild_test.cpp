// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/archive.h"
#include "tests/db/dump.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::IsEmpty;

// An archive with rows in every table.
class RebuildTest : public ::testing::Test {
 protected:
  RebuildTest() {
    const std::string second = "20240601T120000Z-copper";
    {
      Archive archive(optionsFor(path_));
      beginRun(archive);
      for (int number = 0; number < 5; ++number)
        capture(archive, number, static_cast<std::uint64_t>(number));
      beginRun(archive, second);
      capture(archive, 0, 100, second);
      StepRow missed = stepRow(5);
      missed.decision = Decision::kMissed;
      archive.beginStep(missed);
      archive.addDevice({"lux0", "sensor", "twin", "L1", "lux meter"});
      archive.addReading({0, kRunId, "lux0", "illuminance", "lx", {}, 512.25, at(3), "ok"});
      archive.addEvent({0, {}, at(4), "disk", "of no run"});
      StepRow failed = stepRow(6);
      failed.id = archive.beginStep(failed);
      ShotRow shot = shotRow(failed);
      shot.id = archive.armShot(shot);
      archive.failShot(shot, "timeout");
      archive.setRunState(kRunId, "finished");
    }
    CalibrationRow dark;
    dark.kind = "dark";
    dark.device_id = "cam0";
    dark.value_json = "{\"noise\":3}";
    const RowId id = ProductWriter::addCalibration(path_, dark);
    ProductWriter::bind(path_, std::vector{FrameCalibrationRow{1, id, 60.5, 0.25, true}});
    ProductRow product;
    product.id = "ttf-1";
    product.kind = "ttf";
    product.run_id = kRunId;
    product.input_sha256s = {"aa", "bb", "cc"};
    ProductWriter::add(path_, product);
    product.input_sha256s = {"bb"};
    ProductWriter::add(path_, product);
  }
  void expectWhole() {
    for (const auto& p : verify(path_, progress_).problems)
      ADD_FAILURE() << p.what << " " << p.path << " " << p.detail;
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive";
  Progress progress_;
};

TEST_F(RebuildTest, MakesTheSameRowsAgain) {
  expectWhole();
  const auto before = dumpOf(path_);
  ASSERT_GT(before.size(), 40u);
  const RecoveryReport report = rebuild(path_, progress_);
  EXPECT_GT(report.rows_from_journal, 40);
  EXPECT_EQ(dumpOf(path_), before);
  expectWhole();
}

TEST_F(RebuildTest, ACatalogueOfRubbishIsReplaced) {
  const auto before = dumpOf(path_);
  writeFile(path_ / "catalog.sqlite", std::string(100'000, 'x'));
  EXPECT_THROW(ArchiveReader reader(path_), ArchiveError);
  rebuild(path_, progress_);
  EXPECT_EQ(dumpOf(path_), before);
  expectWhole();
}

TEST_F(RebuildTest, ALostCatalogueComesBackByItself) {
  const auto before = dumpOf(path_);
  fs::remove(path_ / "catalog.sqlite");
  { const Archive archive(optionsFor(path_)); }
  EXPECT_EQ(dumpOf(path_), before);
  expectWhole();
}

TEST_F(RebuildTest, ALostJournalIsWrittenFromTheCatalogueFirst) {
  const auto before = dumpOf(path_);
  fs::remove(path_ / "journal" / (kRunId + ".jsonl"));
  rebuild(path_, progress_);
  auto after = dumpOf(path_);
  const auto is_mark = [](const std::string& line) { return line.starts_with("journal_mark"); };
  auto rows = before;
  std::erase_if(rows, is_mark);
  std::erase_if(after, is_mark);
  EXPECT_EQ(after, rows);
  expectWhole();
}

TEST_F(RebuildTest, AStaleWalNeverMeetsTheNewCatalogue) {
  const auto before = dumpOf(path_);
  writeFile(path_ / "catalog.sqlite-wal", std::string(5000, 'w'));
  rebuild(path_, progress_);
  EXPECT_EQ(dumpOf(path_), before);
  expectWhole();
}

TEST_F(RebuildTest, AnArchiveInUseIsNotRebuilt) {
  const Archive archive(optionsFor(path_));
  try {
    rebuild(path_, progress_);
    FAIL() << "rebuilt under its owner";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kTemporary);
  }
}

TEST_F(RebuildTest, FramesThatAreGoneAreMarked) {
  fs::path gone;
  {
    const ArchiveReader reader(path_);
    gone = reader.pathOf(reader.framesBetween(kRunId, at(0), at(1))[0]);
  }
  fs::remove(gone);
  EXPECT_EQ(rebuild(path_, progress_).frames_missing, 1);
  EXPECT_TRUE(ArchiveReader(path_).framesBetween(kRunId, at(0), at(1))[0].missing);
}

}  // namespace
}  // namespace patina::db::testing
