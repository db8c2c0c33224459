// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/sqlite_vfs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "db/database.h"
#include "db/failure.h"
#include "db/schema.h"
#include "tests/db/hooked_disk.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;

class SqliteVfsTest : public ::testing::Test {
 protected:
  SqliteVfsTest() {
    database_.run("CREATE TABLE t(a INTEGER PRIMARY KEY, b)");
    configureAsWriter();
    calls_.clear();
  }
  void configureAsWriter() {
    database_.run("PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL");
    database_.gatherWrites(true);
  }
  std::string callsOn(const std::string& suffix) const {
    std::string text;
    for (const auto& [call, path] : calls_) {
      if (!path.string().ends_with(suffix)) continue;
      if (call == Call::kWrite) text += "write ";
      if (call == Call::kSync) text += "sync ";
      if (call == Call::kTruncate) text += "truncate ";
      if (call == Call::kRemove) text += "remove ";
      if (call == Call::kOpen) text += "create ";
    }
    return text;
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::vector<std::pair<Call, std::filesystem::path>> calls_;
  Call failing_ = Call::kSync;
  int answer_ = 0;
  HookedDisk disk_{[this](Call call, const auto& path) {
    calls_.emplace_back(call, path);
    return call == failing_ ? answer_ : 0;
  }};
  Database database_{folder_ / "x.sqlite", Database::Access::kCreate, disk_};
};

TEST_F(SqliteVfsTest, ACommitIsOneGatheredWriteAndOneSyncOfTheWal) {
  database_.run("INSERT INTO t VALUES(1, 'x')");
  calls_.clear();
  Transaction transaction(database_);
  database_.run("INSERT INTO t VALUES(2, 'y')");
  transaction.commit();
  EXPECT_EQ(callsOn("x.sqlite-wal"), "write sync ");
  EXPECT_EQ(callsOn("x.sqlite"), "") << "the database itself waits for a checkpoint";
}

TEST_F(SqliteVfsTest, ACheckpointPassesTheSeamToo) {
  database_.run("INSERT INTO t VALUES(1, 'x')");
  calls_.clear();
  database_.run("PRAGMA wal_checkpoint(TRUNCATE)");
  EXPECT_THAT(callsOn("x.sqlite"), ::testing::StartsWith("write "));
  EXPECT_THAT(callsOn("x.sqlite"), ::testing::EndsWith("sync "));
  EXPECT_THAT(callsOn("x.sqlite-wal"), ::testing::HasSubstr("truncate "));
}

TEST_F(SqliteVfsTest, ARollbackJournalIsCreatedAndRemovedThroughTheSeam) {
  database_.run("PRAGMA journal_mode=DELETE");
  calls_.clear();
  database_.run("INSERT INTO t VALUES(1, 'x')");
  EXPECT_THAT(callsOn("x.sqlite-journal"), ::testing::StartsWith("create write "));
  EXPECT_THAT(callsOn("x.sqlite-journal"), ::testing::EndsWith("remove "));
  EXPECT_THAT(calls_, ::testing::Contains(std::pair(Call::kSyncFolder, folder_.path())));
}

TEST_F(SqliteVfsTest, LargeTransactionsComeBackWhole) {
  Transaction transaction(database_);
  Statement insert(database_, "INSERT INTO t VALUES(?, ?)");
  for (int i = 1; i <= 300; ++i)
    insert.bind(1, std::int64_t{i}).bind(2, std::string(3000, 'z')).run();
  transaction.commit();
  Database other(folder_ / "x.sqlite", Database::Access::kRead, realFileOps());
  EXPECT_EQ(other.number("SELECT sum(length(b)) FROM t"), 300 * 3000);
  EXPECT_EQ(
      other.number("SELECT count(*) FROM pragma_integrity_check WHERE integrity_check = 'ok'"), 1);
}

TEST_F(SqliteVfsTest, AfterAFailedSyncNothingIsCommittedAnyMore) {
  answer_ = -EIO;
  EXPECT_THROW(database_.run("INSERT INTO t VALUES(1, 'x')"), ArchiveError);
  answer_ = 0;
  EXPECT_THROW(database_.run("INSERT INTO t VALUES(1, 'x')"), ArchiveError)
      << "a page that the kernel calls clean may be lost";
}

TEST_F(SqliteVfsTest, AFullDiskIsToldAndForgiven) {
  failing_ = Call::kWrite;
  answer_ = -ENOSPC;
  EXPECT_THROW(database_.run("INSERT INTO t VALUES(1, 'x')"), DiskFull);
  answer_ = 0;
  database_.run("INSERT INTO t VALUES(1, 'x')");
  EXPECT_EQ(database_.number("SELECT count(*) FROM t"), 1);
}

}  // namespace
}  // namespace patina::db::testing
