// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/app/daemon/scrub_watch.h"

#include <gmock/gmock.h>

#include "db/archive.h"
#include "db/care/scrub.h"
#include "db/product_writer.h"
#include "tests/support/temp_folder.h"

namespace patina::daemon {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

class ScrubWatchTest : public ::testing::Test {
 protected:
  void write(const std::string& kind, const std::string& detail) {
    const std::vector<db::EventRow> rows = {{0, {}, utcFromNs(7), kind, detail}};
    db::ProductWriter::addEvents(folder_.path(), rows);
  }
  std::vector<db::EventRow> news() { return watch_.news(archive_.reader()); }

  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  db::Archive archive_{[this] {
    db::ArchiveOptions options;
    options.folder = folder_.path();
    return options;
  }()};
  ScrubWatch watch_;
};

TEST_F(ScrubWatchTest, TellsOfEachDamageOnce) {
  EXPECT_THAT(news(), IsEmpty());
  write("scrub_damage", "hash frames/ab/cd.jpg of run r, frame 1: is not what it was");
  write("scrub", "3 frames, 1 kB, 1 damaged; 0 never checked");
  const auto damage = news();
  ASSERT_THAT(damage, SizeIs(1));
  EXPECT_THAT(damage[0].detail, ::testing::HasSubstr("frames/ab/cd.jpg"));
  EXPECT_THAT(news(), IsEmpty());
}

TEST_F(ScrubWatchTest, AtFirstKnowsWhatNoCleanSliceCameAfter) {
  write("scrub_damage", "old");
  write("scrub", "3 frames, 1 kB, 0 damaged; 0 never checked");
  write("scrub_damage", "new");
  const auto damage = news();
  ASSERT_THAT(damage, SizeIs(1));
  EXPECT_EQ(damage[0].detail, "new");
}

}  // namespace
}  // namespace patina::daemon
