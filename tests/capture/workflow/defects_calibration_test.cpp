// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/defects_calibration.h"

#include <gtest/gtest.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using calibration::DefectKind;
using testing::TempFolder;

TEST(DefectsFile, GivesBackWhatWasWritten) {
  const TempFolder folder = TempFolder::inMemory();
  const calibration::DefectMap map{
      {640, 480}, 21.5, {{3, 4, DefectKind::kHot, 0.125}, {639, 479, DefectKind::kBright, 1.75}}};
  writeDefects(folder / "d.csv", map);
  const calibration::DefectMap read = readDefects(folder / "d.csv");
  EXPECT_EQ(read.size, map.size);
  EXPECT_EQ(read.temperature_c, 21.5);
  ASSERT_EQ(read.defects.size(), 2u);
  EXPECT_EQ(read.defects[1].x, 639);
  EXPECT_EQ(read.defects[1].kind, DefectKind::kBright);
  EXPECT_EQ(read.defects[0].strength, 0.125);
}

TEST(DefectsFile, OfAnythingElseIsRefusedWithItsLine) {
  const TempFolder folder = TempFolder::inMemory();
  for (const char* text : {"", "x,y\n", "# 4 x 4 at 20 C\nx,y,kind,strength\n1,2,cold,3\n",
                           "# 4 x 4 at 20 C\nx,y,kind,strength\n1,2\n"}) {
    testing::writeFile(folder / "d.csv", text);
    EXPECT_THROW((void)readDefects(folder / "d.csv"), WorkflowError) << text;
  }
}

TEST(MakeDefects, NeedsADarkOrAFlatOfTheCamera) {
  const TempFolder folder = TempFolder::inMemory();
  testing::makeRun(folder.path(), {{{testing::MadeShot{}}}});
  EXPECT_THROW((void)makeDefects(folder.path(), {.camera = "cam0"}, testing::now()), WorkflowError);
  EXPECT_THROW((void)makeDefects(folder.path(), {.camera = "cam0", .dark = 7}, testing::now()),
               WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
