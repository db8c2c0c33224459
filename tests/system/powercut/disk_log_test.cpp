// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/system/powercut/disk_log.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::IsSupersetOf;
using ::testing::UnorderedElementsAre;

class DiskLog : public ::testing::Test {
 protected:
  void add(RecordKind kind, std::uint64_t offset, const std::string& bytes) {
    const RecordHead head{kind, static_cast<std::uint32_t>(bytes.size()), offset};
    log_ += std::string(reinterpret_cast<const char*>(&head), sizeof head) + bytes;
  }
  DiskReplay replay() {
    writeFile(folder_ / "image", std::string(16384, '.'));
    writeFile(folder_ / "log", log_);
    return {folder_ / "image", folder_ / "log"};
  }
  // The first bytes of the two first blocks, over many seeds.
  static std::set<std::string> outcomes(const DiskReplay& replay) {
    std::set<std::string> seen;
    for (std::uint64_t seed = 0; seed < 64; ++seed) {
      const std::string disk = replay.cut(seed);
      seen.insert({disk[0], disk[4096]});
    }
    return seen;
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::string log_;
};

TEST_F(DiskLog, KeepsWhatWasFlushed) {
  add(RecordKind::kWrite, 0, "a");
  add(RecordKind::kFlush, 0, "");
  DiskReplay disk = replay();
  disk.forwardTo(2);
  EXPECT_THAT(outcomes(disk), UnorderedElementsAre("a."));
}

TEST_F(DiskLog, KeepsAnyPartOfWhatWasNot) {
  add(RecordKind::kWrite, 0, "a");
  add(RecordKind::kWrite, 4096, "b");
  DiskReplay disk = replay();
  disk.forwardTo(1);
  EXPECT_THAT(outcomes(disk), UnorderedElementsAre("..", "a."));
  disk.forwardTo(2);
  EXPECT_THAT(outcomes(disk), UnorderedElementsAre("..", "a.", ".b", "ab"));
}

TEST_F(DiskLog, TearsAWriteBetweenItsBlocks) {
  add(RecordKind::kWrite, 0, std::string(8192, 'c'));
  DiskReplay disk = replay();
  disk.forwardTo(1);
  EXPECT_THAT(outcomes(disk), IsSupersetOf({"c.", ".c"}));
}

TEST_F(DiskLog, TellsWhatWasMarkedBeforeTheCut) {
  add(RecordKind::kMark, 0, "ack 1\nack 2\n");
  add(RecordKind::kMark, 0, "ack 3\n");
  DiskReplay disk = replay();
  disk.forwardTo(1);
  EXPECT_THAT(disk.marks(), ElementsAre("ack 1", "ack 2"));
}

TEST_F(DiskLog, RefusesALogThatEndsInTheMiddle) {
  add(RecordKind::kWrite, 0, "abc");
  log_.pop_back();
  EXPECT_THROW(replay(), std::runtime_error);
}

}  // namespace
}  // namespace patina::testing
