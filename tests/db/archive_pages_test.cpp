// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/archive_pages.h"

#include <gtest/gtest.h>

#include "tests/db/small_run.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

class ArchivePagesTest : public ::testing::Test {
 protected:
  ArchivePagesTest() {
    beginRun(archive_);
    for (int number = 0; number < 7; ++number) frames_.push_back(capture(archive_, number, number));
    StepRow by_hand = stepRow(0);
    by_hand.number.reset();
    by_hand.decision = Decision::kFailed;
    archive_.beginStep(by_hand);
    archive_.addEvent({0, kRunId, at(1), "alarm", "dark"});
    archive_.addEvent({0, "", at(2), "shared", "of no run"});
  }

  // All rows of `ask`, by pages of `rows`, and how many pages it took.
  template <class Ask, class KeyOf>
  std::pair<std::size_t, int> all(Ask ask, KeyOf key_of, int rows) {
    std::size_t count = 0;
    int pages = 0;
    for (ArchivePages::Page page{-1, rows};; ++pages) {
      const auto got = ask(page);
      count += got.size();
      if (got.size() < static_cast<std::size_t>(rows)) return {count, pages + 1};
      EXPECT_GT(key_of(got.back()), page.after);
      page.after = key_of(got.back());
    }
  }

  const patina::testing::TempFolder folder_ = patina::testing::TempFolder::inMemory();
  Archive archive_{optionsFor(folder_ / "a")};
  std::vector<std::vector<FrameRow>> frames_;
  const ArchiveReader reader_{folder_ / "a"};
  const ArchivePages pages_{reader_};
};

TEST_F(ArchivePagesTest, EveryRowComesOnceInOrder) {
  const auto steps = all([&](const auto& page) { return pages_.steps(kRunId, page); },
                         [](const StepRow& row) { return *row.number; }, 3);
  EXPECT_EQ(steps, std::pair(std::size_t{7}, 3));
  const auto frames = all([&](const auto& page) { return pages_.frames(kRunId, page); },
                          [](const auto& row) { return row.frame.id; }, 2);
  EXPECT_EQ(frames, std::pair(std::size_t{7}, 4));
  const auto checks = all([&](const auto& page) { return pages_.lightChecks(kRunId, page); },
                          [](const auto& row) { return row.id; }, 10);
  EXPECT_EQ(checks.first, reader_.lightChecks(kRunId).size());
  const auto events = all([&](const auto& page) { return pages_.events(kRunId, page); },
                          [](const auto& row) { return row.id; }, 10);
  EXPECT_EQ(events.first, 1u);
}

TEST_F(ArchivePagesTest, AFrameComesWithItsShot) {
  const auto frames = pages_.frames(kRunId, {-1, 1});
  ASSERT_EQ(frames.size(), 1u);
  EXPECT_EQ(frames[0].shot.device_id, "cam0");
  EXPECT_EQ(frames[0].shot.id, frames[0].frame.shot_id);
  EXPECT_EQ(frames[0].frame.sha256, frames_[0][0].sha256);
}

TEST_F(ArchivePagesTest, StepsByHandComeByThemselves) {
  const auto steps = pages_.stepsByHand(kRunId, 5);
  ASSERT_EQ(steps.size(), 1u);
  EXPECT_FALSE(steps[0].number);
}

TEST_F(ArchivePagesTest, AFrameIsFoundByItsHashAlone) {
  EXPECT_EQ(pages_.frameOf(frames_[4][0].sha256)->id, frames_[4][0].id);
  EXPECT_FALSE(pages_.frameOf(sha256(std::string_view("nothing"))));
}

TEST_F(ArchivePagesTest, KnowsTheDevices) {
  ASSERT_EQ(pages_.devices().size(), 1u);
  EXPECT_EQ(pages_.devices()[0].id, "cam0");
}

TEST_F(ArchivePagesTest, NoPageIsLongerThanTheMost) {
  std::vector<StepRow> many;
  for (int number = 7; number < 7 + kPageRowsMax; ++number) {
    many.push_back(stepRow(number));
    many.back().decision = Decision::kMissed;
  }
  archive_.addSteps(many);
  EXPECT_EQ(pages_.steps(kRunId, {-1, 1'000'000}).size(), std::size_t{kPageRowsMax});
}

}  // namespace
}  // namespace patina::db::testing
