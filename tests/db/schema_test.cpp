// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/schema.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::HasSubstr;

class SchemaTest : public ::testing::Test {
 protected:
  SchemaTest() { Archive archive(optionsFor(path_)); }
  void change(const std::string& sql) {
    Database database(path_ / "catalog.sqlite", Database::Access::kWrite, realFileOps());
    database.run(sql);
  }
  template <class Open>
  void expectRefused(Open open, const std::string& why) {
    try {
      open();
      FAIL() << "opened it: " << why;
    } catch (const ArchiveError& e) {
      EXPECT_EQ(e.exit(), Exit::kBadData);
      EXPECT_THAT(e.what(), HasSubstr(why));
    }
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::filesystem::path path_ = folder_ / "archive";
};

TEST_F(SchemaTest, ANewerSchemaIsRefusedWithBothVersions) {
  change("PRAGMA user_version=99");
  const std::string ours = "up to " + std::to_string(kSchemaVersion);
  for (const std::string& part : {std::string("version 99"), ours}) {
    expectRefused([&] { Archive archive(optionsFor(path_)); }, part);
    expectRefused([&] { ArchiveReader reader(path_); }, part);
    expectRefused([&] { ProductWriter::add(path_, {}); }, part);
    expectRefused(
        [&] {
          Progress progress;
          verify(path_, progress);
        },
        part);
    expectRefused(
        [&] {
          Progress progress;
          rebuild(path_, progress);
        },
        part);
  }
}

TEST_F(SchemaTest, AnEmptyDatabaseBecomesACatalogue) {
  Database empty(folder_ / "empty.sqlite", Database::Access::kCreate, realFileOps());
  migrate(empty);
  EXPECT_EQ(empty.number("PRAGMA user_version"), kSchemaVersion);
  EXPECT_EQ(empty.number("PRAGMA application_id"), kApplicationId);
  EXPECT_EQ(empty.number("SELECT count(*) FROM frame"), 0);
  migrate(empty);  // again: nothing to do
}

TEST_F(SchemaTest, AnotherProgramsDatabaseIsLeftAlone) {
  change("PRAGMA application_id=1234");
  expectRefused([&] { Archive archive(optionsFor(path_)); }, "is not a catalogue of patina");
  expectRefused([&] { ArchiveReader reader(path_); }, "is not a catalogue of patina");
}

TEST_F(SchemaTest, ACapturingConnectionIsDurableAndKeepsItsReferences) {
  Database database(path_ / "catalog.sqlite", Database::Access::kWrite, realFileOps());
  configureWriter(database, Durability::kFull);
  EXPECT_EQ(database.number("PRAGMA synchronous"), 2);
  EXPECT_EQ(database.number("PRAGMA foreign_keys"), 1);
  Statement mode(database, "PRAGMA journal_mode");
  ASSERT_TRUE(mode.step());
  EXPECT_EQ(mode.text(0), "wal");
  EXPECT_THROW(database.run("INSERT INTO shot VALUES(1, 77, 'cam0', 'off', 0, 0, 1, 1.0, 1.0, 0, "
                            "0, 'armed')"),
               ArchiveError);
}

TEST_F(SchemaTest, AFolderWithoutACatalogueIsNoArchive) {
  expectRefused([&] { ArchiveReader reader(folder_.path()); }, "is no archive");
}

}  // namespace
}  // namespace patina::db::testing
