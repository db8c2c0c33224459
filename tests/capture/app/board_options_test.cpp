// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/json_answer.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/support/child.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class BoardOptions : public ::testing::Test {
 protected:
  BoardOptions() {
    plantBoard(folder_ / "board.png", {});
    writeFile(folder_ / "lens.json",
              R"({"width_px":320,"height_px":240,"fx":400.0,"fy":400.0,"cx":159.5,"cy":119.5,)"
              R"("k1":0.0,"k2":0.0,"p1":0.0,"p2":0.0,"k3":0.0})");
  }
  Finished view(std::vector<std::string> board) {
    board.insert(board.begin(),
                 {"calibrate", "view", folder_ / "board.png", "--lens", folder_ / "lens.json"});
    return runPatina(std::move(board));
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(BoardOptions, TakeSquaresInMillimetresAndCentimetres) {
  const auto height_mm = [this](const std::string& square) {
    return answerOf(view({"--board", "7x5", "--square", square, "--json"}))
        .number("/items/0/camera_z_mm");
  };
  EXPECT_NEAR(height_mm("5mm"), 70, 0.7);
  EXPECT_NEAR(height_mm("2cm"), 280, 2.8);
  EXPECT_EQ(view({"--board", "7x5", "--square", "5in"}).exit, 64);
  EXPECT_EQ(view({"--board", "7x5", "--square", "0"}).exit, 64);
}

TEST_F(BoardOptions, AreRefusedWhenTheyTellTwoBoardsOrNoneThatIsMade) {
  const Finished both = view({"--board", "7x5", "--charuco", "8x6", "--square", "5mm"});
  EXPECT_EQ(both.exit, 64);
  EXPECT_THAT(both.err, HasSubstr("either --board or --charuco"));
  EXPECT_EQ(view({"--charuco", "8x6", "--square", "5mm", "--marker", "5mm"}).exit, 64);
  EXPECT_EQ(view({"--board", "2x5", "--square", "5mm"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
