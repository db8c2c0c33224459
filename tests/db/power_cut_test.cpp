// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/power_cut.h"

#include <gmock/gmock.h>

#include <cerrno>
#include <optional>
#include <string>

#include "tests/support/disk/failing_file_ops.h"
#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using ::testing::AnyOf;
using ::testing::Eq;
using testing::readFile;
using testing::TempFolder;
using Mode = FileOps::Mode;

std::span<const std::byte> bytesOf(const std::string& text) {
  return std::as_bytes(std::span(text));
}

// A folder on a disk that can lose its power. A life is one process: its PowerCutFiles goes before
// the cut, its unsynced work stays behind.
class PowerCut : public ::testing::Test {
 protected:
  std::filesystem::path at(const std::string& name) const { return disk_ / name; }

  static std::unique_ptr<File> open(FileOps& files, const std::filesystem::path& path, Mode mode) {
    std::unique_ptr<File> file;
    EXPECT_EQ(files.open(path, mode, &file), 0) << path;
    return file;
  }
  static void write(FileOps& files, const std::filesystem::path& path, const std::string& text,
                    bool synced) {
    auto file = open(files, path, Mode::kCreate);
    EXPECT_EQ(file->write(bytesOf(text), 0), static_cast<std::int64_t>(text.size()));
    if (synced) {
      EXPECT_EQ(file->sync(), 0);
    }
  }
  // A file with its bytes and its name on the disk.
  static void keep(FileOps& files, const std::filesystem::path& path, const std::string& text) {
    write(files, path, text, true);
    EXPECT_EQ(files.syncFolder(path.parent_path()), 0);
  }
  std::optional<std::string> found(const std::string& name) const {
    if (!std::filesystem::exists(at(name))) return std::nullopt;
    return readFile(at(name));
  }
  void wipe() {
    std::filesystem::remove_all(disk_.path());
    std::filesystem::create_directory(disk_.path());
  }

  TempFolder disk_ = TempFolder::inMemory(), log_ = TempFolder::inMemory();
};

constexpr std::uint64_t kSeeds = 60;

TEST_F(PowerCut, NeverTakesWhatWasSynced) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      EXPECT_EQ(files.makeFolder(at("sub")), 0);
      EXPECT_EQ(files.syncFolder(disk_.path()), 0);
      keep(files, at("sub/a"), "kept");
      auto file = open(files, at("sub/a"), Mode::kUpdate);
      file->write(bytesOf("lost, perhaps"), 4);
    }
    const CutReport report = cutPower(log_.path(), seed);
    EXPECT_EQ(report.writes, 1);
    ASSERT_TRUE(found("sub/a"));
    EXPECT_EQ(found("sub/a")->substr(0, 4), "kept");
  }
}

TEST_F(PowerCut, TakesSomeOfWhatWasNotSyncedAndInOrder) {
  int none = 0, all = 0, some = 0;
  const std::string kWant = "0123456789";
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("a"), "");
      auto file = open(files, at("a"), Mode::kUpdate);
      for (int i = 0; i < 10; ++i) file->write(bytesOf(kWant.substr(i, 1)), i);
    }
    cutPower(log_.path(), seed);
    const std::string left = *found("a");
    // Bytes within one sector stay in order; a size without its bytes reads as zeros.
    std::size_t good = 0;
    while (good < left.size() && left[good] == kWant[good]) ++good;
    EXPECT_EQ(left.find_first_not_of('\0', good), std::string::npos) << seed;
    ++(left.empty() ? none : left == kWant ? all : some);
  }
  EXPECT_GT(none, 5);
  EXPECT_GT(all, 5);
  EXPECT_GT(some, 5);
}

TEST_F(PowerCut, GivesOverwrittenBytesBack) {
  bool old_seen = false, new_seen = false;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("a"), "old bytes and their tail");
      auto file = open(files, at("a"), Mode::kUpdate);
      file->write(bytesOf("new"), 0);
      file->truncate(9);
    }
    cutPower(log_.path(), seed);
    const std::string left = *found("a");
    EXPECT_THAT(left, AnyOf(Eq("old bytes and their tail"), Eq("new bytes and their tail"),
                            Eq("new bytes")));
    old_seen = old_seen || left.starts_with("old");
    new_seen = new_seen || left == "new bytes";
  }
  EXPECT_TRUE(old_seen);
  EXPECT_TRUE(new_seen);
}

TEST_F(PowerCut, TearsALongWriteAtSectors) {
  int torn = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    const std::string old_bytes(40960, 'o'), new_bytes(40960, 'n');
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("a"), old_bytes);
      open(files, at("a"), Mode::kUpdate)->write(bytesOf(new_bytes), 0);
    }
    torn += cutPower(log_.path(), seed).torn;
    const std::string left = *found("a");
    ASSERT_EQ(left.size(), old_bytes.size());
    for (std::size_t sector = 0; sector < left.size(); sector += 512)
      EXPECT_EQ(left.substr(sector, 512), std::string(512, left[sector])) << seed;
  }
  EXPECT_GT(torn, 5);
}

TEST_F(PowerCut, TakesARenameBackUntilTheFolderItGoesToIsSynced) {
  int back = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      files.makeFolder(at("tmp"));
      files.makeFolder(at("frames"));
      files.syncFolder(disk_.path());
      keep(files, at("tmp/1"), "one");
      keep(files, at("tmp/2"), "two");
      files.renameNoReplace(at("tmp/1"), at("frames/one"));
      files.syncFolder(at("frames"));
      files.renameNoReplace(at("tmp/2"), at("frames/two"));
      files.syncFolder(at("tmp"));
    }
    cutPower(log_.path(), seed);
    EXPECT_EQ(found("frames/one"), "one");
    EXPECT_NE(found("frames/two"), found("tmp/2")) << "in one place, and in one only";
    EXPECT_EQ(found("frames/two").value_or("two"), "two");
    back += found("tmp/2").has_value();
  }
  EXPECT_GT(back, 5);
  EXPECT_LT(back, static_cast<int>(kSeeds) - 5);
}

TEST_F(PowerCut, KeepsWithARenameTheCreationItRestsUpon) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      files.makeFolder(at("tmp"));
      files.makeFolder(at("frames"));
      files.syncFolder(disk_.path());
      write(files, at("tmp/1"), "one", true);  // tmp/ itself is never synced
      files.renameNoReplace(at("tmp/1"), at("frames/one"));
      files.syncFolder(at("frames"));
    }
    EXPECT_EQ(cutPower(log_.path(), seed).names, 0);
    EXPECT_EQ(found("frames/one"), "one");
  }
}

TEST_F(PowerCut, LosesAFolderWithAllThatIsInItUntilItsParentIsSynced) {
  int lost = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      files.makeFolder(at("ab"));
      keep(files, at("ab/one"), "one");
    }
    cutPower(log_.path(), seed);
    lost += !std::filesystem::exists(at("ab"));
    EXPECT_EQ(std::filesystem::exists(at("ab")), found("ab/one").has_value());
  }
  EXPECT_GT(lost, 5);
  EXPECT_LT(lost, static_cast<int>(kSeeds) - 5);
}

TEST_F(PowerCut, BringsRemovedAndReplacedFilesBack) {
  int removed_back = 0, replaced_back = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("gone"), "gone");
      keep(files, at("target"), "old");
      keep(files, at("source"), "new");
      files.remove(at("gone"));
      files.renameReplace(at("source"), at("target"));
    }
    cutPower(log_.path(), seed);
    EXPECT_EQ(found("gone").value_or("gone"), "gone");
    EXPECT_EQ(*found("target"), found("source") ? "old" : "new");
    removed_back += found("gone").has_value();
    replaced_back += found("source").has_value();
    EXPECT_TRUE(std::filesystem::is_empty(log_ / "grave"));
  }
  EXPECT_GT(removed_back, 5);
  EXPECT_GT(replaced_back, 5);
  EXPECT_GT(replaced_back, removed_back) << "in order: what came second is lost more often";
}

TEST_F(PowerCut, RestoresTheBytesOfARemovedFileAsTheyWereSynced) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("a"), "synced");
      open(files, at("a"), Mode::kUpdate)->write(bytesOf("SYNCED"), 0);
      files.remove(at("a"));
      keep(files, at("b"), "b");  // syncs the folder
      write(files, at("a"), "another", false);
    }
    cutPower(log_.path(), seed);
    EXPECT_EQ(found("b"), "b");
    if (found("a")) {
      EXPECT_EQ(std::string("another").find(found("a")->c_str()), 0u);
    }
  }
}

TEST_F(PowerCut, DoesNotBelieveASyncAfterOneThatFailed) {
  int lost = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    testing::FailingFileOps disk;
    {
      PowerCutFiles files(disk, log_.path());
      keep(files, at("a"), "");
      auto file = open(files, at("a"), Mode::kUpdate);
      file->write(bytesOf("text"), 0);
      disk.resetCounts();
      disk.failCall(testing::FailingFileOps::Call::kSync, 1, EIO);
      EXPECT_EQ(file->sync(), -EIO);
      EXPECT_EQ(file->sync(), 0);
    }
    cutPower(log_.path(), seed);
    lost += *found("a") != "text";
  }
  EXPECT_GT(lost, 5);
}

TEST_F(PowerCut, RemembersAcrossAKillWithoutACut) {
  int lost = 0;
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    {
      PowerCutFiles files(realFileOps(), log_.path());
      keep(files, at("a"), "");
      open(files, at("a"), Mode::kUpdate)->write(bytesOf("first life"), 0);
    }
    {
      PowerCutFiles files(realFileOps(), log_.path());
      auto file = open(files, at("a"), Mode::kUpdate);
      if (seed % 2 == 0) {
        EXPECT_EQ(file->sync(), 0);
      }
    }
    cutPower(log_.path(), seed);
    if (seed % 2 == 0) {
      EXPECT_EQ(found("a"), "first life");
    }
    lost += *found("a") != "first life";
  }
  EXPECT_GT(lost, 5);
}

TEST_F(PowerCut, KeepsItsLogSmallWhenFilesAreSyncedSoon) {
  PowerCutFiles files(realFileOps(), log_.path());
  const std::string page(4096, 'p');
  keep(files, at("wal"), std::string(409600, 'o'));
  auto never_synced = open(files, at("other"), Mode::kCreate);
  never_synced->write(bytesOf(page), 0);
  auto file = open(files, at("wal"), Mode::kUpdate);
  for (int i = 0; i < 20000; ++i) {
    file->write(bytesOf(page), i % 100 * 4096);
    if (i % 5 == 4) file->sync();
  }
  EXPECT_LE(std::filesystem::file_size(log_ / "log0"), 4u << 20);
  EXPECT_LE(std::filesystem::file_size(log_ / "log1"), 4u << 20);
}

TEST_F(PowerCut, StrikesOutAChangeThatFailed) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    wipe();
    testing::FailingFileOps disk;
    {
      PowerCutFiles files(disk, log_.path());
      keep(files, at("a"), "a");
      keep(files, at("b"), "b");
      disk.makeReadOnly();
      EXPECT_EQ(files.renameReplace(at("a"), at("b")), -EROFS);
      EXPECT_EQ(files.remove(at("b")), -EROFS);
      EXPECT_EQ(files.renameNoReplace(at("a"), at("b")), -EROFS);
      std::unique_ptr<File> file;
      EXPECT_EQ(files.open(at("c"), Mode::kCreate, &file), -EROFS);
      disk.heal();
      EXPECT_EQ(files.renameNoReplace(at("a"), at("b")), -EEXIST);
    }
    EXPECT_EQ(cutPower(log_.path(), seed).names, 0);
    EXPECT_EQ(found("a"), "a");
    EXPECT_EQ(found("b"), "b");
  }
}

}  // namespace
}  // namespace patina::db
