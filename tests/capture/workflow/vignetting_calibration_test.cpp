// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/vignetting_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

class VignettingFile : public ::testing::Test {
 protected:
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  VignettingRequest request_;
  Progress progress_;
};

TEST_F(VignettingFile, OfFlatsIsTheirFallOffAndReadsBack) {
  testing::DrawnBoard board;
  board.columns = board.rows = 0;  // nothing but the white around it
  board.falloff = 0.3;
  testing::plantBoard(folder_ / "flats/a.png", board);
  testing::plantBoard(folder_ / "flats/b.png", board);
  request_.sources = {folder_ / "flats"};
  const VignettingCalibration made = makeVignetting(request_, testing::now(), progress_);
  EXPECT_NEAR(made.fit.report.corner, 0.7, 0.005);
  EXPECT_EQ(made.pictures, 2);
  writeFileAtomically(folder_ / "v.json", factsOf(made).json());
  EXPECT_EQ(readVignetting(folder_ / "v.json").a2, made.fit.vignetting.a2);
  writeFileAtomically(folder_ / "v.json", std::string("{}"));
  EXPECT_THROW(readVignetting(folder_ / "v.json"), WorkflowError);
}

TEST_F(VignettingFile, OfABoardFromSeveralPlacesNeedsNoFlat) {
  testing::DrawnBoard board;
  board.falloff = 0.3;
  board.away = 22;
  const double places[][2] = {{0, 0}, {4.5, 3}, {-4.5, 3}, {4.5, -3}, {-4.5, -3}, {0, 3}, {5, 0}};
  int number = 0;
  for (const auto& place : places) {
    board.x = place[0];
    board.y = place[1];
    testing::plantBoard(folder_ / "shots" / (std::to_string(number++) + ".png"), board);
  }
  request_.sources = {folder_ / "shots"};
  request_.board = calibration::BoardSpec{calibration::BoardSpec::kChessboard, 7, 5, 1, 0};
  request_.options.terms = 1;
  const VignettingCalibration made = makeVignetting(request_, testing::now(), progress_);
  EXPECT_NEAR(made.fit.vignetting.at(0.7), 1 - 0.3 * 0.49, 0.006);
}

TEST_F(VignettingFile, OfPicturesOfTwoSizesIsRefused) {
  testing::plantPng(folder_ / "a.png", {320, 240}, 150);
  testing::plantPng(folder_ / "b.png", {240, 320}, 150);
  request_.sources = {folder_ / "a.png", folder_ / "b.png"};
  EXPECT_THROW(makeVignetting(request_, testing::now(), progress_), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
