// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

class ArchiveCare : public Rehearsed {};

TEST_F(ArchiveCare, VerifyIsCleanAfterARehearsal) {
  const JsonAnswer verified = answer({"archive", "verify"});
  EXPECT_EQ(verified.text("/items/0/what"), "clean");
  EXPECT_EQ(verified.number("/items/0/frames"), 12);
}

TEST_F(ArchiveCare, RebuildsTheSameRuns) {
  answer({"archive", "rebuild"});
  EXPECT_EQ(answer({"archive", "list"}).number("/items/0/captured"), 12);
  EXPECT_EQ(patina({"archive", "verify"}).exit, 0);
}

TEST_F(ArchiveCare, RebuildsFromFramesAloneInACopyAndSaysWhatIsLost) {
  const std::string copy = place("copy");
  std::filesystem::copy(archive(), copy, std::filesystem::copy_options::recursive);
  const Finished finished = runPatina({"archive", "rebuild", "--frames-only", "--archive", copy});
  EXPECT_EQ(finished.exit, 0) << finished.err;
  EXPECT_THAT(finished.out, ::testing::HasSubstr("Lost: run, step, light"));
  const JsonAnswer runs = answerOf(runPatina({"archive", "list", "--json", "--archive", copy}));
  EXPECT_EQ(runs.text("/items/0/state"), "recovered");
  EXPECT_EQ(runs.number("/items/0/captured"), 12);
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", copy}).exit, 0);
}

TEST_F(ArchiveCare, VerifyNamesADamagedFrameAndExitsWithBadData) {
  const std::string frame = answer({"archive", "query", "--step", "5"}).text("/items/0/path");
  const std::string whole = readFile(frame);
  std::filesystem::permissions(frame, std::filesystem::perms::owner_all);
  writeFile(frame, whole.substr(0, whole.size() - 1) + "x");
  const Finished finished = patina({"archive", "verify"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.out, ::testing::HasSubstr(std::filesystem::path(frame).filename().string()));
  writeFile(frame, whole);
}

TEST_F(ArchiveCare, AFolderThatIsNoArchiveIsSaidToBeNone) {
  EXPECT_NE(runPatina({"archive", "verify", "--archive", place("nothing")}).exit, 0);
  EXPECT_FALSE(std::filesystem::exists(place("nothing")));
}

}  // namespace
}  // namespace patina::testing
