// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "capture/doctor/facts.h"
#include "db/archive.h"
#include "tests/support/temp_folder.h"

namespace patina::doctor {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using ::testing::HasSubstr;

TEST(ArchiveFacts, LooksAtWhatExistsOfAPathAndMakesNothing) {
  const TempFolder folder;
  const ArchiveFacts facts = archiveFacts(folder / "a" / "b");
  EXPECT_EQ(facts.there, folder.path());
  EXPECT_FALSE(facts.is_archive);
  EXPECT_TRUE(facts.writable);
  EXPECT_GT(facts.free_bytes.value_or(0), 0u);
  EXPECT_NE(facts.file_system, "");
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(ArchiveFacts, NamesTheOwnerOfAnArchiveInUseAndTakesNoLockOfIt) {
  const TempFolder folder = TempFolder::inMemory();
  db::ArchiveOptions options;
  options.folder = folder / "archive";
  options.owner = "patina capture banana.toml";
  {
    const db::Archive archive(options);
    EXPECT_THAT(archiveFacts(options.folder).locked_by, HasSubstr("banana.toml"));
  }
  EXPECT_EQ(archiveFacts(options.folder).locked_by, "");
  EXPECT_TRUE(archiveFacts(options.folder).is_archive);
  const db::Archive again(options);
}

}  // namespace
}  // namespace patina::doctor
