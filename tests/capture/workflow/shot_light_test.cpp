// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/shot_light.h"

#include <gmock/gmock.h>

#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::check;
using ::testing::ElementsAre;

using Checks = std::vector<db::LightCheckRow>;

Checks learning(double r, double g, double b) {
  Checks checks{check("r", r, "learn"), check("g", g, "learn"), check("b", b, "learn")};
  for (db::LightCheckRow& row : checks) row.baseline = 0;
  return checks;
}

TEST(LightGainOf, IsOfTheCamerasOwnPatchBeforeOthers) {
  Checks checks{check("g", 1, "correct", 1.1), check("g", 1, "correct", 1.3)};
  checks[0].source = "sensor:lux0", checks[0].channel = "lx";
  EXPECT_THAT(lightGainOf(checks, "cam0"), ElementsAre(1.1f, 1.3f, 1.1f));
  EXPECT_THAT(lightGainOf(checks, "cam1"), ElementsAre(1.1f, 1.1f, 1.1f));
}

TEST(PatchLevelOf, IsAsSeenWhileABaselineIsLearned) {
  EXPECT_THAT(*patchLevelOf(learning(0.4, 0.6, 0.2), "cam0"), ElementsAre(0.2, 0.3, 0.1));
}

TEST(PatchLevelOf, IsWhatTheGainHasItWhereThereIsABaseline) {
  Checks checks{check("y", 0.8, "correct", 1.25)};
  EXPECT_THAT(*patchLevelOf(checks, "cam0"), ElementsAre(0.4, 0.4, 0.4));
  checks[0] = check("y", 0.3, "covered", 1.25);
  EXPECT_THAT(*patchLevelOf(checks, "cam0"), ElementsAre(0.4, 0.4, 0.4)) << "under its cover";
}

TEST(PatchLevelOf, IsNothingWhereAChannelIsNotTold) {
  EXPECT_FALSE(patchLevelOf({}, "cam0"));
  EXPECT_FALSE(patchLevelOf(learning(0.4, 0.6, 0.2), "cam1"));
  EXPECT_FALSE(patchLevelOf({check("r", 1, "pass"), check("g", 1, "pass")}, "cam0"));
  for (const char* verdict : {"saturated", "hold", "fail", "covered"}) {
    Checks checks = learning(0.4, 0.6, 0.2);
    checks[1].verdict = verdict;
    EXPECT_FALSE(patchLevelOf(checks, "cam0")) << verdict;
  }
  Checks measured = learning(0.4, 1.96, 0.2);  // where nobody judges, nobody says that it clips
  for (db::LightCheckRow& row : measured) row.verdict = "measure";
  EXPECT_FALSE(patchLevelOf(measured, "cam0"));
}

TEST(Patch, IsKeptWithACalibrationAndReadAgain) {
  Facts values;
  addPatch(values, std::nullopt);
  EXPECT_FALSE(patchIn(values));
  addPatch(values, ChannelLevels{0.3, 0.4, 0.2});
  EXPECT_THAT(*patchIn(Facts::parse(values.json())), ElementsAre(0.3, 0.4, 0.2));
}

TEST(ExposureOver, IsTheRatioOfTimeAndIsoWhereBothSay) {
  db::ShotRow one, other;
  one.exposure = std::chrono::milliseconds(40), other.exposure = std::chrono::milliseconds(10);
  EXPECT_DOUBLE_EQ(exposureOver(one, other), 4);
  one.iso = 200, other.iso = 100;
  EXPECT_DOUBLE_EQ(exposureOver(one, other), 8);
  EXPECT_DOUBLE_EQ(exposureOver(one, db::ShotRow{}), 1);
}

}  // namespace
}  // namespace patina::workflow
