// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/file_ops.h"

#include <gtest/gtest.h>

#include <array>
#include <cerrno>
#include <string>

#include "tests/support/temp_folder.h"

namespace patina::db {
namespace {

using Mode = FileOps::Mode;

class FileOpsTest : public ::testing::Test {
 protected:
  std::unique_ptr<File> open(const std::string& name, Mode mode, int want = 0) {
    std::unique_ptr<File> file;
    EXPECT_EQ(ops_.open(folder_ / name, mode, &file), want) << name;
    return file;
  }
  static void write(File& file, const std::string& text, std::int64_t offset) {
    EXPECT_EQ(file.write(std::as_bytes(std::span(text)), offset),
              static_cast<std::int64_t>(text.size()));
  }
  patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
  FileOps& ops_ = realFileOps();
};

TEST_F(FileOpsTest, CreatesOnceAndOpensOnlyWhatIsThere) {
  open("a", Mode::kUpdate, -ENOENT);
  open("a", Mode::kRead, -ENOENT);
  write(*open("a", Mode::kCreate), "hello", 0);
  open("a", Mode::kCreate, -EEXIST);
  const auto again = open("a", Mode::kAppend);
  EXPECT_EQ(again->size(), 5);
  write(*again, " world", again->size());
  EXPECT_EQ(patina::testing::readFile(folder_ / "a"), "hello world");
  EXPECT_EQ(again->truncate(5), 0);
  EXPECT_EQ(again->sync(), 0);
  std::array<std::byte, 16> into{};
  EXPECT_EQ(again->read(into, 3), 2) << "a read ends with the file";
  EXPECT_EQ(open("a", Mode::kRead)->write(into, 0), -EBADF);
}

TEST_F(FileOpsTest, RenamesWithoutReplacingUnlessToldTo) {
  write(*open("a", Mode::kCreate), "a", 0);
  write(*open("b", Mode::kCreate), "b", 0);
  EXPECT_EQ(ops_.renameNoReplace(folder_ / "a", folder_ / "b"), -EEXIST);
  EXPECT_EQ(patina::testing::readFile(folder_ / "b"), "b");
  EXPECT_EQ(ops_.renameReplace(folder_ / "a", folder_ / "b"), 0);
  EXPECT_EQ(patina::testing::readFile(folder_ / "b"), "a");
  EXPECT_EQ(ops_.remove(folder_ / "b"), 0);
  EXPECT_EQ(ops_.remove(folder_ / "b"), -ENOENT);
}

TEST_F(FileOpsTest, FoldersAreMadeOnceAndSynced) {
  EXPECT_EQ(ops_.makeFolder(folder_ / "f"), 0);
  EXPECT_EQ(ops_.makeFolder(folder_ / "f"), -EEXIST);
  EXPECT_EQ(ops_.syncFolder(folder_ / "f"), 0);
  EXPECT_EQ(ops_.syncFolder(folder_ / "g"), -ENOENT);
  Space space;
  EXPECT_EQ(ops_.space(folder_.path(), &space), 0);
  EXPECT_GT(space.total_bytes, 0u);
  EXPECT_LE(space.free_bytes, space.total_bytes);
  EXPECT_EQ(ops_.isNetwork(folder_.path()), 0);
}

TEST_F(FileOpsTest, ALockHasOneOwnerUntilItIsLetGo) {
  std::unique_ptr<FileLock> first, second;
  ASSERT_EQ(ops_.lock(folder_ / "lock", &first), 0);
  EXPECT_EQ(ops_.lock(folder_ / "lock", &second), -EWOULDBLOCK);
  first.reset();
  EXPECT_EQ(ops_.lock(folder_ / "lock", &second), 0);
}

}  // namespace
}  // namespace patina::db
