// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/support/disk/failing_file_ops.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <string>

#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using Call = FailingFileOps::Call;
using Mode = db::FileOps::Mode;

class FailingDisk : public ::testing::Test {
 protected:
  std::unique_ptr<db::File> create(const char* name) {
    std::unique_ptr<db::File> file;
    EXPECT_EQ(disk_.open(folder_ / name, Mode::kCreate, &file), 0);
    return file;
  }
  static std::int64_t write(db::File& file, const std::string& text) {
    return file.write(std::as_bytes(std::span(text)), 0);
  }
  TempFolder folder_ = TempFolder::inMemory();
  FailingFileOps disk_;
};

TEST_F(FailingDisk, FailsTheKthCallOnceAndDoesNotMakeIt) {
  auto file = create("a");
  disk_.resetCounts();
  disk_.failCall(2, ENOSPC);
  EXPECT_EQ(write(*file, "one"), 3);
  EXPECT_EQ(write(*file, "two"), -ENOSPC);
  EXPECT_EQ(readFile(folder_ / "a"), "one");
  EXPECT_EQ(write(*file, "two"), 3);
  EXPECT_EQ(disk_.calls(), 3);
  EXPECT_EQ(disk_.calls(Call::kWrite), 3);
}

TEST_F(FailingDisk, CountsEachKindByItself) {
  auto file = create("a");
  disk_.failCall(Call::kSync, 2, EIO);
  EXPECT_EQ(write(*file, "one"), 3);
  EXPECT_EQ(file->sync(), 0);
  EXPECT_EQ(write(*file, "two"), 3);
  EXPECT_EQ(file->sync(), -EIO);
  EXPECT_EQ(file->sync(), 0);
}

TEST_F(FailingDisk, CountsTheSyncsThatFollowAFailedOne) {
  auto failed = create("a"), other = create("b");
  disk_.failCall(Call::kSync, 1, EIO);
  EXPECT_EQ(failed->sync(), -EIO);
  EXPECT_EQ(other->sync(), 0);
  EXPECT_EQ(disk_.syncsAfterFailure(), 0);
  EXPECT_EQ(failed->sync(), 0);
  EXPECT_EQ(disk_.syncsAfterFailure(), 1);
}

TEST_F(FailingDisk, WritesShortAndSaysSo) {
  auto file = create("a");
  disk_.writeShort(1);
  EXPECT_EQ(write(*file, "four"), 2);
  EXPECT_EQ(readFile(folder_ / "a"), "fo");
}

TEST_F(FailingDisk, IsGoneOnceUnplugged) {
  auto file = create("a");
  disk_.unplugFrom(disk_.calls() + 1);
  std::byte one{};
  EXPECT_EQ(file->read({&one, 1}, 0), -EIO);
  EXPECT_EQ(disk_.syncFolder(folder_.path()), -ENODEV);
  disk_.heal();
  EXPECT_EQ(file->sync(), 0);
}

TEST_F(FailingDisk, RefusesChangesWhenReadOnlyAndReadsOn) {
  auto file = create("a");
  disk_.makeReadOnly();
  EXPECT_EQ(write(*file, "x"), -EROFS);
  EXPECT_EQ(disk_.remove(folder_ / "a"), -EROFS);
  EXPECT_EQ(disk_.makeFolder(folder_.path()), -EEXIST);
  EXPECT_EQ(file->size(), 0);
  EXPECT_EQ(disk_.open(folder_ / "a", Mode::kRead, &file), 0);
}

TEST_F(FailingDisk, MakesRoomByRemovingWhenItIsFull) {
  auto file = create("a");
  disk_.fillUp();
  db::Space space;
  EXPECT_EQ(write(*file, "x"), -ENOSPC);
  EXPECT_EQ(disk_.space(folder_.path(), &space), 0);
  EXPECT_EQ(space.free_bytes, 0u);
  EXPECT_EQ(disk_.remove(folder_ / "a"), 0);
}

}  // namespace
}  // namespace patina::testing
