// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/view_calibration.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

class ViewFile : public ::testing::Test {
 protected:
  ViewFile() {
    testing::DrawnBoard board;
    board.turn_rad = {0.3, 0, 0};
    testing::plantBoard(folder_ / "board.png", board);
    calibration::Lens lens{{320, 240}, 400, 400, 159.5, 119.5, 0, 0, 0, 0, 0};
    writeFileAtomically(folder_ / "lens.json", factsOf(lens).json());
    request_.picture = folder_ / "board.png";
    request_.board = calibration::BoardSpec{calibration::BoardSpec::kChessboard, 7, 5, 5, 0};
    request_.lens = folder_ / "lens.json";
    request_.camera = "cam0";
  }
  ViewCalibration make() { return makeView({}, request_, testing::now(), progress_); }
  testing::TempFolder folder_ = testing::TempFolder::inMemory();
  ViewRequest request_;
  Progress progress_;
};

TEST_F(ViewFile, OfADrawnBoardStandsWhereItWasDrawnFromAndReadsBack) {
  const ViewCalibration made = make();
  EXPECT_NEAR(made.fit.report.camera_mm.z, 14 * 5 * std::cos(0.3), 0.3);
  EXPECT_NEAR(made.fit.report.tilt_deg, 0.3 * 180 / M_PI, 0.3);
  EXPECT_NEAR(made.texels_per_mm, 400.0 / 70, 0.6);
  writeFileAtomically(folder_ / "view.json", factsOf(made, request_).json());
  const KnownView back = readView(folder_ / "view.json");
  EXPECT_EQ(back.view.camera_from_plane, made.fit.view.camera_from_plane);
  EXPECT_EQ(back.view.plane_origin_mm, made.fit.view.plane_origin_mm);
  EXPECT_EQ(back.lens.fx, 400);
}

TEST_F(ViewFile, OfABoardWithOtherSquaresIsFoundOutByARuler) {
  request_.distance_mm = 70 * 1.05;  // as far as glass and centre may lie apart
  EXPECT_NO_THROW(make());
  request_.board->square_mm = 10;  // twice as large as they are
  try {
    make();
    FAIL();
  } catch (const WorkflowError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("0.5"));
    EXPECT_THAT(e.what(), ::testing::HasSubstr("140 mm away"));
  }
}

TEST_F(ViewFile, NeedsALensAndEitherABoardOrMarkers) {
  request_.lens.clear();
  EXPECT_THROW(make(), WorkflowError);
  request_.lens = folder_ / "lens.json";
  request_.fiducials = "markers.txt";
  EXPECT_THROW(make(), WorkflowError) << "both";
  request_.fiducials.clear();
  request_.board.reset();
  EXPECT_THROW(make(), WorkflowError) << "neither";
}

TEST_F(ViewFile, RefusesALensOfAnotherSizeOfPicture) {
  calibration::Lens lens{{640, 480}, 800, 800, 319.5, 239.5, 0, 0, 0, 0, 0};
  writeFileAtomically(folder_ / "lens.json", factsOf(lens).json());
  EXPECT_THROW(make(), WorkflowError);
}

TEST_F(ViewFile, ReadsAListOfMarkersAndNamesTheLineThatIsNone) {
  const std::filesystem::path list = folder_ / "markers.txt";
  writeFileAtomically(list, std::string("# the frame\n\n3 -40 25\n7 40 25.5 90  # turned\n"));
  const auto markers = readFiducials(list);
  ASSERT_EQ(markers.size(), 2u);
  EXPECT_EQ(markers[0].id, 3);
  EXPECT_EQ(markers[1].y_mm, 25.5);
  EXPECT_EQ(markers[1].turn_deg, 90);
  writeFileAtomically(list, std::string("3 -40 25\n71 0 0\n"));
  try {
    readFiducials(list);
    FAIL();
  } catch (const WorkflowError& e) {
    EXPECT_THAT(e.what(), ::testing::HasSubstr("markers.txt:2"));
  }
}

}  // namespace
}  // namespace patina::workflow
