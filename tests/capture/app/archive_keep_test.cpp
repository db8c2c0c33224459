// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

class ArchiveKeep : public Rehearsed {
 protected:
  static std::string frame(int step) {
    return answer({"archive", "query", "--step", std::to_string(step)}).text("/items/0/path");
  }
  static void damage(const std::string& path) {
    fs::permissions(path, fs::perms::owner_all);
    writeFile(path, readFile(path).replace(10, 1, "?"));
  }
};

TEST_F(ArchiveKeep, ABackupIsRestoredByNamingIt) {
  const JsonAnswer made = answer({"archive", "backup", place("backup")});
  EXPECT_EQ(made.number("/items/0/frames_copied"), 12);
  EXPECT_EQ(made.number("/items/0/problems"), 0);
  EXPECT_EQ(answer({"archive", "backup", place("backup")}).number("/items/0/frames_copied"), 0);
  EXPECT_EQ(runPatina({"archive", "verify", "--archive", place("backup")}).exit, 0);
  EXPECT_EQ(answerOf(runPatina({"archive", "list", "--json", "--archive", place("backup")}))
                .number("/items/0/captured"),
            12);
}

TEST_F(ArchiveKeep, ABackupOfADamagedArchiveIs65AndNamesTheFrame) {
  const std::string path = frame(3), whole = readFile(path);
  damage(path);
  const Finished finished = patina({"archive", "backup", place("backup-of-damage")});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.out, HasSubstr(fs::path(path).filename().string()));
  writeFile(path, whole);
}

TEST_F(ArchiveKeep, ABackupIntoTheArchiveIs64) {
  EXPECT_EQ(patina({"archive", "backup", archive() + "/backup"}).exit, 64);
}

TEST_F(ArchiveKeep, GcSaysWhatItWouldDoAndMarks) {
  writeFile(archive() + "/frames/letter.txt", "dear");
  const JsonAnswer dry = answer({"archive", "gc", "--dry-run"});
  EXPECT_EQ(dry.text("/items/0/action"), "marked");
  EXPECT_EQ(dry.number("/items/0/bytes"), 4);
  EXPECT_FALSE(fs::exists(archive() + "/care/gc-marks"));
  answer({"archive", "gc"});
  EXPECT_EQ(answer({"archive", "gc"}).text("/items/0/action"), "waiting");
  EXPECT_TRUE(fs::exists(archive() + "/frames/letter.txt"));
  EXPECT_EQ(patina({"archive", "gc", "--grace", "1min"}).exit, 64);
  fs::remove(archive() + "/frames/letter.txt");
}

TEST_F(ArchiveKeep, ScrubFindsDamageAndExitsWithBadData) {
  EXPECT_EQ(answer({"archive", "scrub"}).number("/items/0/frames"), 12);
  const std::string path = frame(5), whole = readFile(path);
  damage(path);
  const Finished finished = patina({"archive", "scrub", "--max-duration", "1min"});
  EXPECT_EQ(finished.exit, 65);
  EXPECT_THAT(finished.out, HasSubstr(fs::path(path).filename().string()));
  writeFile(path, whole);
}

}  // namespace
}  // namespace patina::testing
