// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/run_report.h"

#include <gtest/gtest.h>

#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

TEST(RunReport, CountsStepsFramesAndVerdicts) {
  const testing::TempFolder folder = testing::TempFolder::inMemory();
  testing::MadeShot shot;
  shot.checks = {testing::check("r", 0.98, "correct", 1.02)};
  const std::string run =
      testing::makeRun(folder.path(), {{{shot}}, {{shot}, 2}, {{testing::MadeShot{}}}});
  const RunReport report = reportRun(db::ArchiveReader(folder.path()), run);
  EXPECT_EQ(report.steps_due, 3);
  EXPECT_EQ(report.captured, 3);
  EXPECT_EQ(report.partial, 1);
  EXPECT_EQ(report.frames, 3);
  ASSERT_EQ(report.light_verdicts.size(), 1u);
  EXPECT_EQ(report.light_verdicts[0].second, 2);
  EXPECT_DOUBLE_EQ(report.gain_most, 1.02);
}

}  // namespace
}  // namespace patina::workflow
