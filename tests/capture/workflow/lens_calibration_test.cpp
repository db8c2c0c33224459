// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lens_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

class LensFile : public ::testing::Test {
 protected:
  LensFile() {
    testing::plantBoards(folder_ / "boards");
    request_.sources = {folder_ / "boards"};
    request_.board = {calibration::BoardSpec::kChessboard, 7, 5, 1, 0};
    request_.options = {0, false, true};
    request_.command = "patina calibrate lens";
    request_.version = "test";
  }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  LensRequest request_;
  Progress progress_;
};

TEST_F(LensFile, OfDrawnBoardsHasTheirFocalLengthAndNamesThePictureWithout) {
  const LensCalibration made = makeLens(request_, testing::now(), progress_);
  EXPECT_NEAR(made.fit.lens.fx, 400, 4);
  EXPECT_NEAR(made.fit.lens.cx, 159.5, 2);
  EXPECT_LT(made.fit.report.rms_px, 0.1);
  EXPECT_THAT(made.left_out, ::testing::ElementsAre("e.png"));
}

TEST_F(LensFile, ReadsBackToTheBitAndNamesWhatAnotherFileLacks) {
  const LensCalibration made = makeLens(request_, testing::now(), progress_);
  const std::filesystem::path file = folder_ / "lens.json";
  writeFileAtomically(file, factsOf(made, request_).json());
  const calibration::Lens back = readLens(file);
  EXPECT_EQ(back.fx, made.fit.lens.fx);
  EXPECT_EQ(back.cy, made.fit.lens.cy);
  EXPECT_EQ(back.size, made.fit.lens.size);
  writeFileAtomically(file, std::string(R"({"width_px":3,"height_px":2,"fx":1.0})"));
  try {
    readLens(file);
    FAIL();
  } catch (const WorkflowError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("no number \"fy\""));
  }
}

TEST_F(LensFile, SaysAtWhichZoomItWasMeasured) {
  LensCalibration made = makeLens(request_, testing::now(), progress_);
  EXPECT_FALSE(factsOf(made, request_).number("focal_mm")) << "drawn boards do not say";
  made.pictures.zoom = {35, 0.5};
  EXPECT_EQ(factsOf(made, request_).number("focal_mm"), 35);
  EXPECT_EQ(factsOf(made, request_).number("focus_m"), 0.5);
}

TEST_F(LensFile, IsKeptForItsCameraAndSizeAndItsOwnTime) {
  const std::filesystem::path archive = folder_ / "archive";
  testing::makeRun(archive, {{{testing::MadeShot{}}}});
  LensCalibration made = makeLens(request_, testing::now(), progress_);
  const KeptCalibration first = keepLens(archive, made, request_, "cam0", testing::now());
  made.pictures.taken += std::chrono::hours(48);
  const KeptCalibration later = keepLens(archive, made, request_, "cam0", testing::now());
  const db::ArchiveReader reader(archive);
  EXPECT_EQ(first.row.kind, "lens");
  EXPECT_EQ(later.row.size, (SizePx{320, 240}));
  EXPECT_EQ(later.row.utc - first.row.utc, std::chrono::hours(48));
  EXPECT_EQ(readLens(fileOfCalibration(reader, first.row)).fx, made.fit.lens.fx);
}

}  // namespace
}  // namespace patina::workflow
