// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/care/gc_marks.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace patina::db::care {
namespace {

namespace fs = std::filesystem;
using patina::testing::TempFolder;
using patina::testing::writeFile;

class GcMarks : public ::testing::Test {
 protected:
  GcMarks() { fs::create_directory(folder_ / "care"); }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(GcMarks, ReadBackAsTheyWereWritten) {
  const Marks marks = {{"frames/ab/c d.jpg", {{7, 8, 9}, utcFromNs(10)}},
                       {"products/x", {{1, 2, 3}, utcFromNs(-4)}}};
  writeMarks(realFileOps(), folder_.path(), marks);
  const Marks again = readMarks(realFileOps(), folder_.path());
  ASSERT_EQ(again.size(), 2u);
  EXPECT_EQ(again.at("frames/ab/c d.jpg").identity, (Identity{7, 8, 9}));
  EXPECT_EQ(again.at("products/x").since, utcFromNs(-4));
}

TEST_F(GcMarks, RubbishOnlyMakesThingsWaitAgain) {
  EXPECT_TRUE(readMarks(realFileOps(), folder_.path()).empty());
  writeFile(folder_ / "care" / "gc-marks", "7 8 9 10 frames/a\nrubbish\n1 2");
  EXPECT_EQ(readMarks(realFileOps(), folder_.path()).size(), 1u);
}

TEST_F(GcMarks, ANameThatWouldBreakTheFileIsLeftOut) {
  writeMarks(realFileOps(), folder_.path(), {{"frames/a\nb", {}}, {"frames/c", {}}});
  EXPECT_EQ(readMarks(realFileOps(), folder_.path()).size(), 1u);
}

TEST_F(GcMarks, AFoldersIdentityChangesWithAnyFileInIt) {
  fs::create_directories(folder_ / "p" / "q");
  writeFile(folder_ / "p" / "q" / "a", "1");
  const Identity before = identityOf(folder_ / "p");
  EXPECT_EQ(identityOf(folder_ / "p"), before);
  writeFile(folder_ / "p" / "q" / "a", "12");
  EXPECT_NE(identityOf(folder_ / "p"), before);
  EXPECT_EQ(identityOf(folder_ / "nothing"), Identity{});
}

}  // namespace
}  // namespace patina::db::care
