// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/database.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "db/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using patina::testing::TempFolder;

class DatabaseTest : public ::testing::Test {
 protected:
  TempFolder folder_ = TempFolder::inMemory();
  Database database_{folder_ / "x.sqlite", Database::Access::kCreate, realFileOps()};
};

TEST_F(DatabaseTest, ATransactionThatIsNotCommittedLeavesNothing) {
  database_.run("CREATE TABLE t(a)");
  {
    Transaction transaction(database_);
    database_.run("INSERT INTO t VALUES(1)");
  }
  EXPECT_EQ(database_.number("SELECT count(*) FROM t"), 0);
  {
    Transaction transaction(database_);
    database_.run("INSERT INTO t VALUES(1)");
    transaction.commit();
  }
  EXPECT_EQ(database_.number("SELECT count(*) FROM t"), 1);
}

TEST_F(DatabaseTest, ValuesComeBackAsTheyWereBound) {
  database_.run("CREATE TABLE t(i INTEGER, r REAL, n REAL, s TEXT, e TEXT, z INTEGER) STRICT");
  const std::string text("nul \0 inside", 12);
  Statement insert(database_, "INSERT INTO t VALUES(?, ?, ?, ?, ?, ?)");
  insert.bind(1, std::numeric_limits<std::int64_t>::min()).bind(2, 0.1);
  insert.bind(3, std::nan("")).bind(4, text).bind(5, std::string_view()).bindNull(6);
  insert.run();
  Statement select(database_, "SELECT * FROM t");
  ASSERT_TRUE(select.step());
  EXPECT_EQ(select.integer(0), std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(select.real(1), 0.1);
  EXPECT_TRUE(std::isnan(select.real(2)));
  EXPECT_EQ(select.text(3), text);
  EXPECT_FALSE(select.isNull(4)) << "an empty text is not NULL";
  EXPECT_TRUE(select.isNull(5));
}

TEST_F(DatabaseTest, WhatIsNoDatabaseIsBadDataAndSaysWhatToDo) {
  patina::testing::writeFile(folder_ / "y.sqlite", std::string(8192, 'y'));
  Database broken(folder_ / "y.sqlite", Database::Access::kWrite, realFileOps());
  try {
    broken.number("SELECT count(*) FROM sqlite_schema");
    FAIL() << "read letters as a database";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kBadData);
    EXPECT_THAT(e.what(), ::testing::HasSubstr("patina archive rebuild"));
  }
}

TEST_F(DatabaseTest, AReaderCannotWrite) {
  database_.run("CREATE TABLE t(a)");
  Database reader(folder_ / "x.sqlite", Database::Access::kRead, realFileOps());
  EXPECT_THROW(reader.run("INSERT INTO t VALUES(1)"), ArchiveError);
  EXPECT_THROW(Database(folder_ / "none.sqlite", Database::Access::kWrite, realFileOps()),
               ArchiveError);
}

TEST_F(DatabaseTest, AnotherDatabaseIsAttachedToRead) {
  database_.run("CREATE TABLE t(a); INSERT INTO t VALUES(7)");
  Database scratch{Database::Scratch{}};
  scratch.attach(folder_ / "x.sqlite", "other");
  EXPECT_EQ(scratch.number("SELECT a FROM other.t"), 7);
  EXPECT_THROW(scratch.run("INSERT INTO other.t VALUES(8)"), ArchiveError);
}

}  // namespace
}  // namespace patina::db
