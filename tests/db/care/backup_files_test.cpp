// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/backup_files.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/db/hooked_disk.h"
#include "tests/support/temp_folder.h"

namespace patina::db::care {
namespace {

using db::testing::Call;
using db::testing::HookedDisk;
using patina::testing::readFile;
using patina::testing::TempFolder;
using patina::testing::writeFile;

class BackupFiles : public ::testing::Test {
 protected:
  BackupFiles() { std::filesystem::create_directory(folder_ / "tmp"); }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(BackupFiles, LoadsAWholeFileWithItsHash) {
  writeFile(folder_ / "a", "ripe");
  const Loaded loaded = load(realFileOps(), folder_ / "a");
  EXPECT_EQ(loaded.error, 0);
  EXPECT_EQ(loaded.sha256, sha256(std::string_view("ripe")));
  EXPECT_EQ(load(realFileOps(), folder_ / "b").error, ENOENT);
  EXPECT_EQ(sizeOf(folder_ / "b"), -1);
}

TEST_F(BackupFiles, SaysWhenAFileCannotBeRead) {
  writeFile(folder_ / "a", "ripe");
  HookedDisk disk([](Call call, const auto&) { return call == Call::kRead ? -EIO : 0; });
  EXPECT_EQ(load(disk, folder_ / "a").error, EIO);
}

TEST_F(BackupFiles, CopiesNoMoreThanAskedAlsoWhenWritesAreShort) {
  const std::string text(3'000'000, 'p');
  writeFile(folder_ / "a", text);
  HookedDisk disk(
      [](Call call, const auto&) { return call == Call::kWrite ? db::testing::kShortWrite : 0; });
  const Copied copied = copyToTemporary(disk, folder_ / "a", folder_.path(), 2'500'000);
  EXPECT_EQ(copied.bytes, 2'500'000);
  EXPECT_EQ(readFile(copied.temporary), text.substr(0, 2'500'000));
  EXPECT_EQ(copied.sha256, sha256(text.substr(0, 2'500'000)));
  const Copied all = copyToTemporary(disk, folder_ / "a", folder_.path(),
                                     std::numeric_limits<std::int64_t>::max());
  EXPECT_EQ(all.bytes, 3'000'000);
}

}  // namespace
}  // namespace patina::db::care
