// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class ArchiveExport : public Rehearsed {};

TEST_F(ArchiveExport, WritesARunsFramesAndGoesOnWhereItStopped) {
  const std::vector<std::string> command = {"archive", "export", "latest", place("out")};
  const JsonAnswer first = answer(command);
  EXPECT_EQ(first.number("/items/0/frames"), 12);
  EXPECT_EQ(first.number("/items/0/written"), 12);
  EXPECT_EQ(answer(command).number("/items/0/written"), 0);
}

TEST_F(ArchiveExport, LinksOnRequest) {
  EXPECT_EQ(
      answer({"archive", "export", "latest", place("linked"), "--link"}).number("/items/0/linked"),
      12);
}

TEST_F(ArchiveExport, NamesThePresetsThereAre) {
  const Finished finished =
      patina({"archive", "export", "--preset", "btf", "latest", place("btf")});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("utc"));
  EXPECT_FALSE(std::filesystem::exists(place("btf")));
}

TEST_F(ArchiveExport, AFolderInUseForSomethingElseIs73) {
  std::filesystem::create_directories(place("used"));
  writeFile(place("used/letter.txt"), "dear");
  EXPECT_EQ(patina({"archive", "export", "latest", place("used")}).exit, 73);
}

}  // namespace
}  // namespace patina::testing
