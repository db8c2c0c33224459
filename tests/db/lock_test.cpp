// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/lock.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <csignal>

#include "tests/db/hooked_disk.h"
#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::HasSubstr;

class LockTest : public ::testing::Test {
 protected:
  // Opens an archive on a disk where calls of one kind answer `error`.
  void expectRefused(Call kind, int answer, Exit exit, const std::string& why) {
    HookedDisk disk([&](Call call, const auto&) { return call == kind ? answer : 0; });
    try {
      Archive archive(optionsFor(folder_ / "archive", &disk));
      FAIL() << "opened: " << why;
    } catch (const ArchiveError& e) {
      EXPECT_EQ(e.exit(), exit);
      EXPECT_THAT(e.what(), HasSubstr(why));
    }
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(LockTest, AFileSystemWithoutLocksIsRefused) {
  expectRefused(Call::kLock, -ENOLCK, Exit::kCannotCreate, "has no locks");
  expectRefused(Call::kLock, -EOPNOTSUPP, Exit::kCannotCreate, "has no locks");
}

TEST_F(LockTest, AFileSystemThatCannotRenameWithoutReplacingIsRefused) {
  expectRefused(Call::kRename, -EINVAL, Exit::kCannotCreate, "cannot rename without replacing");
}

TEST_F(LockTest, AFileSystemThatCannotSyncFoldersIsRefused) {
  HookedDisk disk([](Call call, const auto& path) {
    return call == Call::kSyncFolder && path.filename() == "tmp" ? -EINVAL : 0;
  });
  EXPECT_THROW(Archive archive(optionsFor(folder_ / "archive", &disk)), ArchiveError);
}

TEST_F(LockTest, ANetworkFileSystemIsRefusedUnlessAllowed) {
  expectRefused(Call::kIsNetwork, 1, Exit::kCannotCreate, "is a network file system");
  HookedDisk disk([](Call call, const auto&) { return call == Call::kIsNetwork ? 1 : 0; });
  ArchiveOptions options = optionsFor(folder_ / "archive", &disk);
  options.allow_network_file_system = true;
  EXPECT_NO_THROW(Archive{options});
}

TEST_F(LockTest, AReadOnlyDiskSaysSo) {
  { Archive archive(optionsFor(folder_ / "archive")); }
  HookedDisk disk([](Call call, const auto&) {
    const bool changes = call == Call::kWrite || call == Call::kLock || call == Call::kMakeFolder ||
                         call == Call::kRename || call == Call::kRemove;
    return changes ? -EROFS : 0;
  });
  try {
    Archive archive(optionsFor(folder_ / "archive", &disk));
    FAIL() << "opened a read-only archive to write";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kCannotCreate);
    EXPECT_THAT(e.what(), HasSubstr("read-only"));
  }
  EXPECT_NO_THROW(ArchiveReader(folder_ / "archive").runs());
}

TEST_F(LockTest, AForbiddenFolderIsAMatterOfPermission) {
  expectRefused(Call::kMakeFolder, -EACCES, Exit::kPermission, "Permission denied");
}

TEST_F(LockTest, TheLockOfAKilledProcessIsFree) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    std::filesystem::create_directory(folder_ / "a");
    const auto lock = takeLock(realFileOps(), folder_.path(), "patina capture banana.toml");
    if (::write(ready[1], "x", 1) != 1) ::_exit(1);
    for (;;) ::pause();
  }
  char byte = 0;
  ASSERT_EQ(::read(ready[0], &byte, 1), 1);
  try {
    takeLock(realFileOps(), folder_.path(), "second");
    ADD_FAILURE() << "two owners";
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kTemporary);
    EXPECT_THAT(e.what(),
                HasSubstr("'patina capture banana.toml' (pid " + std::to_string(child) + " on "));
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_NO_THROW(takeLock(realFileOps(), folder_.path(), "second"));
  ::close(ready[0]);
  ::close(ready[1]);
}

}  // namespace
}  // namespace patina::db::testing
