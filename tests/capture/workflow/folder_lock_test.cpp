// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/folder_lock.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include "capture/workflow/failure.h"
#include "processing/image/picture_file.h"
#include "tests/support/temp_folder.h"

namespace patina::workflow {
namespace {

namespace fs = std::filesystem;
using testing::TempFolder;

bool isFree(const fs::path& folder) {
  const int fd = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const bool got = ::flock(fd, LOCK_EX | LOCK_NB) == 0;
  ::close(fd);
  return got;
}

TEST(FolderLock, KeepsOthersOutAsLongAsItLives) {
  const TempFolder folder = TempFolder::inMemory();
  const fs::path set = folder / "set";
  {
    const FolderLock lock(set);
    EXPECT_FALSE(isFree(set));
  }
  EXPECT_TRUE(isFree(set));
}

TEST(FolderLock, SweepsWhatAProcessThatDiedLeftHalfWritten) {
  const TempFolder folder = TempFolder::inMemory();
  fs::create_directories(folder / "set/t0001.tmp99-0");
  fs::create_directories(folder / "set/t0000");
  const FolderLock lock(folder / "set");
  EXPECT_FALSE(fs::exists(folder / "set/t0001.tmp99-0"));
  EXPECT_TRUE(fs::exists(folder / "set/t0000"));
}

TEST(FolderLock, SaysWhereAFolderCannotBe) {
  const TempFolder folder = TempFolder::inMemory();
  writeFileAtomically(folder / "file", std::string("x"));
  EXPECT_THROW(FolderLock(folder / "file/set"), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
