// SPDX-License-Identifier: GPL-3.0-or-later
#include "db/catalogue_read.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "tests/db/many_rows.h"
#include "tests/support/temp_folder.h"

namespace patina::db::testing {
namespace {

using patina::testing::TempFolder;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

class CatalogueReadTest : public ::testing::Test {
 protected:
  static constexpr std::int64_t kFrames = 20'000;
  static const std::filesystem::path& archive() {
    static const TempFolder folder = TempFolder::inMemory();
    static const std::filesystem::path path = [] {
      auto made = folder / "archive";
      {
        Archive owner(optionsFor(made));
        beginRun(owner);
      }
      fillCatalogue(made, kFrames);
      return made;
    }();
    return path;
  }
  const ArchiveReader reader_{archive()};
};

TEST_F(CatalogueReadTest, NoQuestionScansATable) {
  // These answer with the whole of a small table, which is what was asked for.
  const std::set<Query> whole = {Query::kRuns, Query::kCalibrations, Query::kProducts,
                                 Query::kDevices};
  Database database(archive() / "catalog.sqlite", Database::Access::kRead, realFileOps());
  for (int q = 0; q < kQueryCount; ++q) {
    const auto query = static_cast<Query>(q);
    const std::string sql = sqlOf(query);
    std::string plan;
    Statement explain(database, "EXPLAIN QUERY PLAN " + sql);
    while (explain.step()) plan += std::string(explain.text(3)) + "\n";
    ASSERT_NE(plan, "") << sql;
    if (whole.contains(query)) continue;
    // The partial index on armed shots holds only those, so scanning it is the search.
    if (query == Query::kArmedShots) {
      EXPECT_THAT(plan, HasSubstr("USING INDEX shot_armed"));
      continue;
    }
    EXPECT_THAT(plan, Not(HasSubstr("SCAN"))) << sql;
    EXPECT_THAT(plan, HasSubstr("SEARCH")) << sql;
  }
}

TEST_F(CatalogueReadTest, FramesAreStreamedInOrderOfTheirStepsWithoutSorting) {
  Database database(archive() / "catalog.sqlite", Database::Access::kRead, realFileOps());
  Statement explain(database, "EXPLAIN QUERY PLAN " + sqlOf(Query::kEachFrame));
  while (explain.step()) EXPECT_THAT(std::string(explain.text(3)), Not(HasSubstr("B-TREE")));
  std::int64_t last = 0, count = 0;
  reader_.eachFrame(kRunId, [&](const ArchiveReader::CapturedFrame& f) {
    EXPECT_GT(*f.step.number, last);
    EXPECT_EQ(f.shot.step_id, f.step.id);
    EXPECT_EQ(f.frame.shot_id, f.shot.id);
    last = *f.step.number;
    // The reader may be asked in between.
    if (++count % 5000 == 0) {
      EXPECT_THAT(reader_.framesOfStep(f.step.id), SizeIs(1));
    }
  });
  EXPECT_EQ(count, kFrames - kFrames / 100);
}

TEST_F(CatalogueReadTest, FindsFramesByRunStepAndTime) {
  ASSERT_TRUE(reader_.newestFrame(kRunId));
  EXPECT_EQ(reader_.newestFrame(kRunId)->id, kFrames - 1);
  EXPECT_FALSE(reader_.newestFrame("nobody"));
  EXPECT_THAT(reader_.framesOfStep(77), SizeIs(1));
  EXPECT_THAT(reader_.framesOfStep(100), IsEmpty()) << "missed";
  EXPECT_THAT(reader_.framesBetween(kRunId, at(5), at(5 * 11)), SizeIs(10));
  EXPECT_THAT(reader_.framesBetween(kRunId, at(5), at(5)), IsEmpty());
}

TEST_F(CatalogueReadTest, FindsStepsByNumberAndDecision) {
  EXPECT_EQ(reader_.step(kRunId, 100)->decision, Decision::kMissed);
  EXPECT_FALSE(reader_.step(kRunId, kFrames + 1));
  EXPECT_THAT(reader_.steps(kRunId, Decision::kHeld), SizeIs(kFrames / 10'000));
  EXPECT_THAT(reader_.steps(kRunId, Decision::kMissed), SizeIs(kFrames / 100 - kFrames / 10'000));
  EXPECT_THAT(reader_.steps(kRunId, Decision::kFailed), IsEmpty());
}

}  // namespace
}  // namespace patina::db::testing
