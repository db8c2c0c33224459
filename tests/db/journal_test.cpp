// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/journal.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/failure.h"
#include "tests/db/hooked_disk.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::readFile;
using patina::testing::TempFolder;

class JournalTest : public ::testing::Test {
 protected:
  JournalTest() { std::filesystem::create_directory(folder_ / "journal"); }
  std::string content() const { return readFile(journalPath(folder_.path(), "run")); }
  TempFolder folder_ = TempFolder::inMemory();
  std::function<int(Call, const std::filesystem::path&)> hook_;
  HookedDisk disk_{[this](Call call, const auto& path) { return hook_ ? hook_(call, path) : 0; }};
};

TEST_F(JournalTest, ContinuesWhereItEnded) {
  {
    Journal journal(disk_, folder_.path(), "run");
    journal.write("one\n");
    journal.sync();
    journal.settle();
  }
  Journal journal(disk_, folder_.path(), "run");
  EXPECT_EQ(journal.size(), 4);
  journal.write("two\n");
  EXPECT_TRUE(journal.pending());
  EXPECT_EQ(content(), "one\ntwo\n");
}

TEST_F(JournalTest, TakesBackWhatWasNotCommitted) {
  Journal journal(disk_, folder_.path(), "run");
  journal.write("one\n");
  journal.settle();
  journal.write("two\n");
  journal.takeBack();
  EXPECT_EQ(content(), "one\n");
  journal.write("three\n");
  EXPECT_EQ(content(), "one\nthree\n");
}

TEST_F(JournalTest, AHalfWrittenLineIsCutBeforeTheNext) {
  Journal journal(disk_, folder_.path(), "run");
  journal.write("one\n");
  journal.settle();
  int writes = 0;
  hook_ = [&](Call call, const auto&) {
    if (call == Call::kTruncate) return -EIO;
    if (call != Call::kWrite) return 0;
    return ++writes == 1 ? kShortWrite : -ENOSPC;
  };
  EXPECT_THROW(journal.write("two\n"), DiskFull);
  journal.takeBack();  // fails too
  EXPECT_EQ(content(), "one\ntw");
  hook_ = {};
  journal.write("three\n");
  EXPECT_EQ(content(), "one\nthree\n");
}

TEST_F(JournalTest, IsNeverSyncedAgainAfterAnInputOutputError) {
  Journal journal(disk_, folder_.path(), "run");
  int syncs = 0;
  hook_ = [&](Call call, const auto&) { return call == Call::kSync && ++syncs == 1 ? -EIO : 0; };
  journal.write("one\n");
  EXPECT_THROW(journal.sync(), ArchiveError);
  journal.takeBack();
  journal.write("two\n");
  EXPECT_THROW(journal.sync(), ArchiveError) << "what the kernel calls clean may be lost";
  EXPECT_EQ(syncs, 1);
}

TEST_F(JournalTest, IsSyncedAgainWhenThereIsRoomAgain) {
  Journal journal(disk_, folder_.path(), "run");
  int syncs = 0;
  hook_ = [&](Call call, const auto&) { return call == Call::kSync && ++syncs == 1 ? -ENOSPC : 0; };
  journal.write("one\n");
  EXPECT_THROW(journal.sync(), DiskFull);
  journal.sync();
  EXPECT_EQ(syncs, 2);
}

TEST_F(JournalTest, TheSharedJournalFollowsOtherWriters) {
  Journal ours(disk_, folder_.path(), "run");
  patina::testing::writeFile(journalPath(folder_.path(), "run"), "theirs\ntorn");
  EXPECT_EQ(ours.sizeOnDisk(), 11);
  ours.refresh(7);
  ours.write("ours\n");
  EXPECT_EQ(content(), "theirs\nours\n");
}

TEST_F(JournalTest, TheSharedJournalIsNamedFirst) {
  for (const char* name : {"b", "_archive", "a"}) Journal(disk_, folder_.path(), name);
  EXPECT_THAT(journalNames(folder_.path()), ::testing::ElementsAre("_archive", "a", "b"));
}

}  // namespace
}  // namespace patina::db::testing
