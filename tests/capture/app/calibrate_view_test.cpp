// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/rehearsed.h"
#include "tests/capture/workflow/drawn_board.h"

namespace patina::testing {
namespace {

class CalibrateView : public Rehearsed {
 protected:
  // A camera of the rig's picture size whose lens has 200 px, over a board of 8x6 squares.
  std::string board() {
    DrawnBoard drawn;
    drawn.size = {128, 128};
    drawn.focal_px = 200;
    drawn.turn_rad = {0.1, 0, 0};
    drawn.away = 17;
    plantBoard(place("board.png"), drawn);
    return place("board.png");
  }
  std::string lens() {
    writeFile(place("lens.json"),
              R"({"width_px":128,"height_px":128,"fx":200.0,"fy":200.0,"cx":63.5,"cy":63.5,)"
              R"("k1":0.0,"k2":0.0,"p1":0.0,"p2":0.0,"k3":0.0})");
    return place("lens.json");
  }
};

TEST_F(CalibrateView, KeepsAViewByWhichTheNextTextureIsRectified) {
  const JsonAnswer view = answer({"calibrate", "view", board(), "--board", "7x5", "--square", "5mm",
                                  "--lens", lens(), "--camera", "cam0"});
  EXPECT_NEAR(view.number("/items/0/camera_z_mm"), 85 * std::cos(0.1), 1);
  EXPECT_NEAR(view.number("/items/0/tilt_deg"), 5.7, 0.7);
  // The run was rehearsed in another year than the picture is of.
  EXPECT_EQ(patina({"ttf", "build", "--rectify"}).exit, 65);
  const JsonAnswer built = answer({"ttf", "build", "--rectify", "--stale-calibration", "--region",
                                   "-15,-12,30,20", "--texels-per-mm", "2"});
  EXPECT_EQ(built.number("/items/0/width_px"), 60);
  EXPECT_EQ(built.number("/items/0/height_px"), 40);
  EXPECT_EQ(built.number("/items/0/mm_per_texel"), 0.5);
}

TEST_F(CalibrateView, AsksForTheSquaresAndTheLens) {
  EXPECT_EQ(patina({"calibrate", "view", board(), "--board", "7x5", "--lens", lens()}).exit, 64);
  EXPECT_EQ(patina({"calibrate", "view", board(), "--board", "7x5", "--square", "5mm"}).exit, 64);
  EXPECT_EQ(patina({"ttf", "build", "--region", "0,0,10,10"}).exit, 64) << "without --rectify";
  EXPECT_EQ(patina({"ttf", "build", "--rectify", "--roi", "0,0,10,10"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
