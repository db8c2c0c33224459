// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/board_pictures.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

class BoardFiles : public ::testing::Test {
 protected:
  BoardPictures search(const std::vector<std::string>& sources, int columns, int rows,
                       std::size_t least = 3) {
    Progress progress;
    return searchBoards(picturesNamed(sources),
                        {calibration::BoardSpec::kChessboard, columns, rows, 1, 0}, least,
                        testing::now(), progress);
  }
  std::string refusal(const std::vector<std::string>& sources, int columns, int rows) {
    try {
      search(sources, columns, rows);
    } catch (const Failure& e) {
      return e.what();
    }
    return "none";
  }
  std::string place(const std::string& name) const { return folder_ / name; }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(BoardFiles, AreNamedByPatternFolderAndFileInOrderAndOnce) {
  for (const char* name : {"left10.png", "left2.png", "right1.png"})
    testing::plantPng(folder_ / name, {8, 8}, 100);
  const auto names = [&](const std::vector<std::string>& sources) {
    std::vector<std::string> out;
    for (const auto& file : picturesNamed(sources)) out.push_back(file.filename().string());
    return out;
  };
  EXPECT_THAT(names({place("left*.png")}), ::testing::ElementsAre("left2.png", "left10.png"));
  EXPECT_THAT(names({place("right1.png"), place("")}),
              ::testing::ElementsAre("right1.png", "left2.png", "left10.png"));
  EXPECT_THROW(picturesNamed({place("none*.png")}), WorkflowError);
}

TEST_F(BoardFiles, AreSearchedAndThoseWithoutTheBoardStayInTheList) {
  testing::plantBoards(folder_ / "boards");
  const BoardPictures all = search({place("boards")}, 7, 5);
  ASSERT_EQ(all.pictures.size(), 5u);
  EXPECT_EQ(all.size, (SizePx{320, 240}));
  for (std::size_t i = 0; i < 4; ++i) EXPECT_TRUE(all.pictures[i].sight) << i;
  EXPECT_EQ(all.pictures[4].name, "e.png");
  EXPECT_FALSE(all.pictures[4].sight);
  EXPECT_EQ(all.taken, testing::now()) << "the files do not say when";
}

TEST_F(BoardFiles, OfABoardOfAnotherSizeAreRefusedWithTheSizeTheyShow) {
  testing::plantBoards(folder_ / "boards");
  std::filesystem::remove(folder_ / "boards/e.png");
  EXPECT_THAT(refusal({place("boards")}, 8, 6), HasSubstr("7x5 inner corners, not 8x6"));
  EXPECT_THAT(refusal({place("boards")}, 6, 5), HasSubstr("7x5 inner corners, not 6x5"));
}

TEST_F(BoardFiles, OfNoBoardOrOfTwoSizesAreRefused) {
  for (const char* name : {"a.png", "b.png"}) testing::plantPng(folder_ / name, {64, 48}, 100);
  EXPECT_THAT(refusal({place("")}, 7, 5),
              ::testing::AllOf(HasSubstr("found in 0 of 2"), HasSubstr("a.png, b.png")));
  testing::plantPng(folder_ / "c.png", {48, 64}, 100);
  EXPECT_THAT(refusal({place("")}, 7, 5), HasSubstr("c.png is 48x64 pixels and a.png is 64x48"));
}

}  // namespace
}  // namespace patina::workflow
