// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/http/private_file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "capture/app/http/messages.h"
#include "tests/support/temp_folder.h"

namespace patina::http {
namespace {

TEST(PrivateFile, IsForItsOwnerWhateverTheUmask) {
  const auto folder = testing::TempFolder::inMemory();
  writePrivateFile(folder / "f", "secret");
  struct stat facts {};
  ASSERT_EQ(stat((folder / "f").c_str(), &facts), 0);
  EXPECT_EQ(facts.st_mode & 0777, 0600u);
  EXPECT_EQ(readPrivateFile(folder / "f", 100), "secret");
}

TEST(PrivateFile, ReplacesAnOldOneAndWhatADeadStartLeft) {
  const auto folder = testing::TempFolder::inMemory();
  testing::writeFile(folder / "f.new", "half");
  writePrivateFile(folder / "f", "one");
  writePrivateFile(folder / "f", "two");
  EXPECT_EQ(readPrivateFile(folder / "f", 100), "two");
}

TEST(PrivateFile, RefusesToReadWhatOthersMayReadToo) {
  const auto folder = testing::TempFolder::inMemory();
  writePrivateFile(folder / "f", "secret");
  chmod((folder / "f").c_str(), 0640);
  EXPECT_THROW(readPrivateFile(folder / "f", 100), HttpError);
}

TEST(PrivateFile, RefusesALinkAFolderAndWhatIsTooLarge) {
  const auto folder = testing::TempFolder::inMemory();
  writePrivateFile(folder / "f", "secret");
  ASSERT_EQ(symlink("f", (folder / "link").c_str()), 0);
  EXPECT_THROW(readPrivateFile(folder / "link", 100), HttpError);
  EXPECT_THROW(readPrivateFile(folder.path(), 100), HttpError);
  EXPECT_THROW(readPrivateFile(folder / "f", 5), HttpError);
  EXPECT_FALSE(readPrivateFile(folder / "nothing", 100));
}

TEST(ReadKey, RefusesAKeyThatEverybodyMayReadAndFollowsLinks) {
  const auto folder = testing::TempFolder::inMemory();
  testing::writeFile(folder / "pem", "text");
  ASSERT_EQ(symlink("pem", (folder / "link").c_str()), 0);
  chmod((folder / "pem").c_str(), 0640);
  EXPECT_EQ(readKey(folder / "link"), "text");
  chmod((folder / "pem").c_str(), 0644);
  EXPECT_THROW(readKey(folder / "link"), HttpError);
  EXPECT_EQ(readCertificate(folder / "link"), "text");
  EXPECT_THROW(readCertificate(folder / "nothing"), HttpError);
}

}  // namespace
}  // namespace patina::http
