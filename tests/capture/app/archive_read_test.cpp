// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class ArchiveRead : public Rehearsed {};

TEST_F(ArchiveRead, ListsRunsWithTheirCounts) {
  const JsonAnswer list = answer({"archive", "list"});
  EXPECT_EQ(list.size("/items"), 1u);
  EXPECT_EQ(list.text("/items/0/state"), "finished");
  EXPECT_EQ(list.number("/items/0/captured"), 12);
}

TEST_F(ArchiveRead, ShowsARunWithItsPlan) {
  const Finished finished = patina({"archive", "show", "latest"});
  EXPECT_EQ(finished.exit, 0);
  EXPECT_THAT(finished.out, HasSubstr("interval = \"10min\""));
  EXPECT_THAT(answer({"archive", "show", "2024"}).text("/items/0/rig_toml"), HasSubstr("quick"));
}

TEST_F(ArchiveRead, ShowsAProduct) {
  const std::string id = answer({"ttf", "list"}).text("/items/0/id");
  EXPECT_EQ(answer({"archive", "show", id}).text("/items/0/kind"), "ttf");
}

TEST_F(ArchiveRead, FindsStepsAndFrames) {
  EXPECT_EQ(answer({"archive", "query"}).size("/items"), 12u);
  EXPECT_EQ(answer({"archive", "query", "--decision", "missed"}).size("/items"), 0u);
  const JsonAnswer frame = answer({"archive", "query", "--step", "3"});
  EXPECT_EQ(frame.size("/items"), 1u);
  EXPECT_TRUE(std::filesystem::exists(frame.text("/items/0/path")));
  EXPECT_EQ(answer({"archive", "query", "--newest"}).size("/items"), 1u);
  EXPECT_EQ(
      answer({"archive", "query", "--from", "2024-05-01T12:29:00Z", "--to", "2024-05-01T12:51:00Z"})
          .size("/items"),
      3u);
}

TEST_F(ArchiveRead, AnUnknownRunIsAUsageErrorThatNamesTheChoices) {
  const Finished finished = patina({"archive", "show", "1999"});
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("20240501T120000Z-copper"));
  EXPECT_EQ(patina({"archive", "query", "--step", "99"}).exit, 64);
  EXPECT_EQ(patina({"archive", "query", "--decision", "eaten"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
