// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/light_report.h"

#include <gmock/gmock.h>

#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::check;
using ::testing::Contains;
using ::testing::HasSubstr;
using testing::MadeShot;
using testing::MadeStep;
using testing::TempFolder;

LightReport reportOf(const std::vector<db::LightCheckRow>& checks) {
  const TempFolder folder = TempFolder::inMemory();
  std::vector<MadeStep> steps;
  for (const db::LightCheckRow& one : checks) {
    MadeShot shot;
    shot.checks = {one};
    steps.push_back({{shot}});
  }
  const std::string run = testing::makeRun(folder.path(), steps);
  return reportLight(db::ArchiveReader(folder.path()), run);
}

TEST(LightReport, CountsVerdictsAndRanges) {
  const LightReport report = reportOf({check("r", 1.0, "learn"), check("r", 0.98, "correct", 1.02),
                                       check("r", 0.97, "correct", 1.03), check("r", 1, "pass")});
  ASSERT_EQ(report.series.size(), 1u);
  EXPECT_EQ(report.series[0].verdicts.at("correct"), 2);
  EXPECT_DOUBLE_EQ(report.series[0].ratio_min, 0.97);
  EXPECT_DOUBLE_EQ(report.series[0].gain_max, 1.03);
  EXPECT_TRUE(report.spells.empty());
  EXPECT_THAT(report.sentences, Contains(HasSubstr("2 of 4 checks")));
  EXPECT_THAT(report.sentences, Contains("The light was never out of its band."));
}

TEST(LightReport, TellsWhenALampWasOut) {
  const LightReport report = reportOf({check("r", 1, "pass"), check("r", 0.01, "hold"),
                                       check("r", 0.0, "hold"), check("r", 1, "pass")});
  ASSERT_EQ(report.spells.size(), 1u);
  EXPECT_EQ(report.spells[0].from, testing::now() + std::chrono::minutes(10));
  EXPECT_EQ(report.spells[0].to, testing::now() + std::chrono::minutes(20));
  EXPECT_THAT(report.sentences, Contains("key was out from 2024-05-01T00:10 to 2024-05-01T00:20."));
}

TEST(LightReport, KeepsSpellsApartThatAGoodCheckParts) {
  EXPECT_EQ(reportOf({check("r", 1.2, "hold"), check("r", 1, "pass"), check("r", 1.2, "hold")})
                .spells.size(),
            2u);
}

TEST(LightReport, TellsCoveredAndSaturatedPatchesApart) {
  const LightReport report = reportOf({check("r", 1, "pass"), check("r", 0.4, "covered"),
                                       check("r", 1, "pass"), check("r", 2, "saturated")});
  EXPECT_THAT(report.sentences, Contains(HasSubstr("patch was covered")));
  EXPECT_THAT(report.sentences, Contains(HasSubstr("clipped its patch")));
}

TEST(LightReport, OfARunWithoutChecksSaysSo) {
  EXPECT_THAT(reportOf({}).sentences, ::testing::ElementsAre("This run has no light checks."));
}

}  // namespace
}  // namespace patina::workflow
