// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/trash.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/schema.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using patina::testing::writeFile;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class TrashTest : public ::testing::Test {
 protected:
  TrashTest() {
    Archive archive(optionsFor(path_));
    beginRun(archive);
    capture(archive, 0, 1);
    frame_ = archive.reader().pathOf(*archive.reader().newestFrame(kRunId));
  }
  fs::path trashed(const fs::path& path) const {
    return path_ / "trash" / path.lexically_relative(path_);
  }
  void throwAway(const fs::path& path) const {
    fs::create_directories(trashed(path).parent_path());
    fs::rename(path, trashed(path));
  }
  TempFolder folder_ = TempFolder::inMemory();
  fs::path path_ = folder_ / "archive", frame_;
};

TEST_F(TrashTest, AFrameThatARowNamesComesBack) {
  throwAway(frame_);
  const auto catalogue = openForReading(path_ / "catalog.sqlite");
  EXPECT_THAT(returnNamedFrames(realFileOps(), path_, *catalogue, {}), ElementsAre(frame_));
  EXPECT_TRUE(fs::exists(frame_));
}

TEST_F(TrashTest, AFrameThatOnlyAJournalLineNamesComesBack) {
  const Bytes bytes = frameBytes(77);
  FrameRecord record;
  record.row.sha256 = sha256(bytes);
  record.row.ext = "jpg";
  const fs::path place = path_ / framePath(record.row.sha256, "jpg");
  fs::create_directories(trashed(place).parent_path());
  writeFile(trashed(place), "x");
  JournalTail tail;
  tail.batches.push_back({{record}, 0, 1, 0});
  const auto catalogue = openForReading(path_ / "catalog.sqlite");
  EXPECT_THAT(returnNamedFrames(realFileOps(), path_, *catalogue, {}), IsEmpty());
  EXPECT_THAT(returnNamedFrames(realFileOps(), path_, *catalogue, {tail}), ElementsAre(place));
}

TEST_F(TrashTest, TheNextStartPutsBackWhatASweepThatDiedLeft) {
  throwAway(frame_);
  const Archive archive(optionsFor(path_));
  EXPECT_TRUE(fs::exists(frame_));
  EXPECT_EQ(archive.recovery().frames_missing, 0);
}

TEST_F(TrashTest, WhatLiesInItsPlaceAgainIsNotReplaced) {
  fs::create_directories(trashed(frame_).parent_path());
  writeFile(trashed(frame_), "older");
  const auto catalogue = openForReading(path_ / "catalog.sqlite");
  EXPECT_THAT(returnNamedFrames(realFileOps(), path_, *catalogue, {}), IsEmpty());
  EXPECT_EQ(fs::file_size(frame_), 3000u);
}

// What makes a sweep safe: db/trash.h. Whoever looks for a frame in its place has said so before.
TEST_F(TrashTest, AShotsJournalLineIsThereBeforeItsFileIsLookedForInItsPlace) {
  bool looked = false;
  ArchiveOptions options = optionsFor(path_);
  options.at_point = [&](CommitPoint point) {
    if (point != CommitPoint::kRenamed) return;
    looked = true;
    const auto catalogue = openForReading(path_ / "catalog.sqlite");
    CatalogueWriter marks(*catalogue);
    const auto tails = readTails(realFileOps(), path_, *catalogue, marks);
    EXPECT_TRUE(isNamed(*catalogue, tails, {sha256(frameBytes(2)), "jpg"}));
  };
  Archive archive(options);
  capture(archive, 1, 2);
  EXPECT_TRUE(looked);
}

}  // namespace
}  // namespace patina::db::testing
