// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <sys/stat.h>

#include "processing/image/atomic_file.h"
#include "processing/image/picture_file.h"
#include "tests/processing/image/samples.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using testing::TempFolder;

int filesIn(const fs::path& folder) {
  return static_cast<int>(std::distance(fs::directory_iterator(folder), fs::directory_iterator{}));
}

TEST(ReadFile, GivesTheBytesAndRefusesMoreThanTheLimit) {
  const TempFolder folder;
  testing::writeFile(folder / "a", "hello");
  EXPECT_EQ(patina::readFile(folder / "a"), bytesOf("hello"));
  EXPECT_EQ(patina::readFile(folder / "a", 5).size(), 5u);
  EXPECT_THAT(refusalOf([&] { patina::readFile(folder / "a", 4); }), HasSubstr("larger than"));
  testing::writeFile(folder / "empty", "");
  EXPECT_TRUE(patina::readFile(folder / "empty").empty());
}

TEST(ReadFile, SaysWhatIsWrongWithAPath) {
  const TempFolder folder;
  EXPECT_THAT(refusalOf([&] { patina::readFile(folder / "absent"); }),
              HasSubstr("No such file or directory"));
  EXPECT_THAT(refusalOf([&] { patina::readFile(folder.path()); }), HasSubstr("is a folder"));
}

TEST(ReadFile, StopsAtTheLimitOfAFileWithoutASize) {
  EXPECT_THAT(refusalOf([] { patina::readFile("/dev/zero", 1 << 20); }), HasSubstr("larger than"));
}

TEST(WriteFileAtomically, ReplacesAndLeavesNothingBeside) {
  const TempFolder folder;
  writeFileAtomically(folder / "a", std::string("one"));
  writeFileAtomically(folder / "a", std::string("two, and longer"));
  EXPECT_EQ(testing::readFile(folder / "a"), "two, and longer");
  EXPECT_EQ(filesIn(folder.path()), 1);
}

TEST(WriteFileAtomically, FailsWithoutATraceWhereItCannotWrite) {
  const TempFolder folder;
  EXPECT_THROW(writeFileAtomically(folder / "none" / "a", std::string("x")), ProcessingError);
  fs::create_directory(folder / "taken");
  EXPECT_THROW(writeFileAtomically(folder / "taken", std::string("x")), ProcessingError);
  EXPECT_EQ(filesIn(folder.path()), 1);
  try {
    writeFileAtomically("/dev/full/a", std::string("x"));
    ADD_FAILURE();
  } catch (const ProcessingError& e) {
    EXPECT_EQ(e.exit(), Exit::kCannotCreate);
  }
}

TEST(TemporaryBeside, NeverRepeatsAndStaysInTheFolder) {
  const fs::path a = temporaryBeside("/x/film.mp4"), b = temporaryBeside("/x/film.mp4");
  EXPECT_NE(a, b);
  EXPECT_EQ(a.parent_path(), "/x");
}

TEST(PublishAtomically, RemovesTheTemporaryFileOnFailure) {
  const TempFolder folder;
  testing::writeFile(folder / "t", "x");
  fs::create_directory(folder / "taken");
  EXPECT_THROW(publishAtomically(folder / "t", folder / "taken"), ProcessingError);
  EXPECT_FALSE(fs::exists(folder / "t"));
}

TEST(WriteFolderAtomically, PutsTheNewOneInPlaceOrLeavesTheOldOne) {
  const TempFolder folder;
  const auto write = [&](const std::string& text) {
    writeFolderAtomically(folder / "set", [&](const fs::path& into) {
      testing::writeFile(into / text, text);
      if (text == "bad") throw ProcessingError(Exit::kBadData, "no");
    });
  };
  write("old");
  EXPECT_THROW(write("bad"), ProcessingError);
  EXPECT_TRUE(fs::exists(folder / "set" / "old"));
  write("new");
  EXPECT_FALSE(fs::exists(folder / "set" / "old"));
  EXPECT_TRUE(fs::exists(folder / "set" / "new"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), {}), 1) << "nothing stays beside";
}

}  // namespace
}  // namespace patina
