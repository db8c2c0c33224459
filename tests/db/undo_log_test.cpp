// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/undo_log.h"

#include <gmock/gmock.h>

#include <string>

#include "db/failure.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using testing::TempFolder;
using Kind = UndoEntry::Kind;

UndoEntry write(std::uint64_t file, const std::string& path) {
  UndoEntry e;
  e.kind = Kind::kWrite;
  e.file = file;
  e.path = path;
  return e;
}

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

std::string imageOf(const UndoLog& log, const UndoEntry& e) {
  const auto bytes = log.image(e);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

TEST(UndoLog, IsReadBackByTheNextProcess) {
  const TempFolder folder = TempFolder::inMemory();
  {
    UndoLog log(folder.path());
    EXPECT_EQ(log.newFile(), 1u);
    log.add(write(1, "/a/x"), bytesOf("old"));
    log.add(write(1, "/a/x"), bytesOf("older"));
  }
  UndoLog log(folder.path());
  const auto& file = log.unsynced().files().at(1);
  EXPECT_EQ(file.path, "/a/x");
  ASSERT_EQ(file.changes.size(), 2u);
  EXPECT_EQ(imageOf(log, file.changes[1]), "older");
  EXPECT_EQ(log.nextSeq(), 3u);
  EXPECT_EQ(log.newFile(), 2u);
}

TEST(UndoLog, RefusesToGuessWhenItIsDamaged) {
  const TempFolder folder = TempFolder::inMemory();
  UndoLog(folder.path()).add(write(1, "/a/x"), bytesOf("old"));
  std::string bytes = testing::readFile(folder / "log0");
  bytes[0] ^= 1;
  testing::writeFile(folder / "log0", bytes);
  EXPECT_THROW(UndoLog(folder.path()), ArchiveError);
}

TEST(UndoLog, StrikesOutARenameThatWasAnnouncedAndNeverMade) {
  const TempFolder folder = TempFolder::inMemory(), log_folder = TempFolder::inMemory();
  testing::writeFile(folder / "a", "a");
  UndoEntry rename;
  rename.kind = Kind::kRename;
  rename.path = folder / "a", rename.to = folder / "b";
  rename.inode = 1;  // of no file here
  UndoLog(log_folder.path()).add(rename);
  EXPECT_TRUE(UndoLog(log_folder.path()).unsynced().names().empty());
}

TEST(UndoLog, KeepsWhatIsUnsyncedWhenItIsCompacted) {
  const TempFolder folder = TempFolder::inMemory();
  UndoEntry create;
  create.kind = Kind::kCreate;
  create.path = "/a/x";
  {
    UndoLog log(folder.path());
    log.add(create);
    log.add(write(log.newFile(), "/a/x"), bytesOf("kept"));
    const std::uint64_t busy = log.newFile();
    const std::string page(1 << 16, 'p');
    for (int i = 0; i < 300; ++i) {
      log.add(write(busy, "/a/busy"), bytesOf(page));
      UndoEntry synced;
      synced.kind = Kind::kSynced;
      synced.file = busy;
      synced.upto = log.nextSeq() - 1;
      log.add(synced);
    }
    EXPECT_EQ(imageOf(log, log.unsynced().files().at(1).changes.at(0)), "kept");
  }
  EXPECT_LE(std::filesystem::file_size(folder / "log0"), 4u << 20);
  const UndoLog log(folder.path());
  EXPECT_EQ(imageOf(log, log.unsynced().files().at(1).changes.at(0)), "kept");
  ASSERT_EQ(log.unsynced().names().size(), 1u);
  EXPECT_EQ(log.unsynced().files().size(), 1u);
}

TEST(UndoLog, BuriesAFileSoThatItsBytesOutliveItsName) {
  const TempFolder folder = TempFolder::inMemory(), log_folder = TempFolder::inMemory();
  testing::writeFile(folder / "a", "bytes");
  UndoLog log(log_folder.path());
  EXPECT_EQ(log.bury(folder / "a", 7), 0);
  std::filesystem::remove(folder / "a");
  EXPECT_EQ(testing::readFile(log.grave(7)), "bytes");
  log.forget();
  EXPECT_FALSE(std::filesystem::exists(log.grave(7)));
}

}  // namespace
}  // namespace patina::db
