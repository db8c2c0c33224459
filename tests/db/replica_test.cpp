// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/replica.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST(Replica, NamesTheTableAndKeyOfEachDifference) {
  const TempFolder folder = TempFolder::inMemory();
  const auto path = folder / "archive";
  {
    Archive archive(optionsFor(path));
    beginRun(archive);
    capture(archive, 0, 1);
  }
  const auto differences = [&] {
    std::vector<std::string> found;
    const auto note = [&](const Replica::Difference& d) { found.push_back(d.table + " " + d.key); };
    Replica replica(path);
    EXPECT_EQ(replica.journals(), 2);
    replica.replayAll(note, [] {});
    replica.compare(note);
    return found;
  };
  EXPECT_THAT(differences(), IsEmpty());
  {
    Database database(path / "catalog.sqlite", Database::Access::kWrite, realFileOps());
    database.run("PRAGMA foreign_keys=OFF; DELETE FROM shot WHERE id = 1");
  }
  EXPECT_THAT(differences(), ::testing::ElementsAre("shot 1"));
  std::filesystem::remove(journalPath(path, kRunId));
  EXPECT_THAT(differences(), ::testing::Contains("journal " + journalPath(path, kRunId).string()));
}

}  // namespace
}  // namespace patina::db::testing
