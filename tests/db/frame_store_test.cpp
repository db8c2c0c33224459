// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/frame_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;

class FrameStoreTest : public ::testing::Test {
 protected:
  FrameStoreTest() {
    for (const char* name : {"tmp", "frames"}) std::filesystem::create_directory(folder_ / name);
  }
  bool place() {
    const auto temporary = store_.writeTemporary(bytes_, "jpg");
    return store_.place(temporary, hash_, "jpg", bytes_);
  }
  TempFolder folder_ = TempFolder::inMemory();
  ArchiveOptions options_ = optionsFor(folder_.path());
  FrameStore store_{realFileOps(), options_};
  Bytes bytes_ = frameBytes(1);
  Sha256 hash_ = sha256(bytes_);
  std::filesystem::path place_ = folder_ / framePath(hash_, "jpg");
};

TEST_F(FrameStoreTest, AFrameLiesUnderTheDigitsOfItsHash) {
  EXPECT_TRUE(place());
  const std::string hex = hash_.hex();
  EXPECT_EQ(place_, folder_ / "frames" / hex.substr(0, 2) / (hex.substr(2) + ".jpg"));
  EXPECT_EQ(readFile(place_), bytes_);
}

TEST_F(FrameStoreTest, EqualBytesAreStoredOnceAndNothingIsLeftBehind) {
  EXPECT_TRUE(place());
  EXPECT_FALSE(place());
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
}

TEST_F(FrameStoreTest, DamagedBytesUnderTheNameAreSetAsideNotKept) {
  EXPECT_TRUE(place());
  patina::testing::writeFile(place_, "rotten");
  EXPECT_TRUE(place());
  EXPECT_EQ(readFile(place_), bytes_);
  EXPECT_EQ(patina::testing::readFile(folder_ / "quarantine" / (hash_.hex() + "-damaged.jpg")),
            "rotten");
}

TEST_F(FrameStoreTest, AnExtensionCannotLeaveTheFolder) {
  for (const char* bad : {"", "..", "/etc", "a/b", "jp g", "abcdefghijklmnopq"})
    EXPECT_THROW(checkExtension(bad), ArchiveError) << bad;
  checkExtension("nef");
}

}  // namespace
}  // namespace patina::db::testing
