// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/errors.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>

namespace patina::db {
namespace {

Exit exitOf(int error) {
  try {
    checkDisk(-error, "writing", "/archive/x");
  } catch (const ArchiveError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("writing /archive/x: "));
    return e.exit();
  }
  return Exit::kOk;
}

TEST(Errors, TellTheCallerWhatToDo) {
  EXPECT_EQ(exitOf(0), Exit::kOk);
  EXPECT_EQ(exitOf(EIO), Exit::kIo);
  EXPECT_EQ(exitOf(ENODEV), Exit::kIo);
  EXPECT_EQ(exitOf(EROFS), Exit::kCannotCreate);
  EXPECT_EQ(exitOf(EACCES), Exit::kPermission);
}

TEST(Errors, AFullDiskAndAFullQuotaAreTheSameToTheCaller) {
  EXPECT_THROW(checkDisk(-ENOSPC, "writing", "x"), DiskFull);
  EXPECT_THROW(checkDisk(-EDQUOT, "writing", "x"), DiskFull);
  EXPECT_EQ(exitOf(ENOSPC), Exit::kCannotCreate);
}

TEST(Errors, AnArchiveThatIsGoneIsADiskThatFailed) {
  try {
    throwGone("/media/disk/ivy");
  } catch (const ArchiveError& e) {
    EXPECT_EQ(e.exit(), Exit::kIo);
    EXPECT_NE(std::string(e.what()).find("/media/disk/ivy"), std::string::npos);
  }
}

}  // namespace
}  // namespace patina::db
