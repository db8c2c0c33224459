// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tests/capture/app/json_answer.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class CalibrateLens : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TempFolder>(TempFolder::inMemory());
    plantBoards(*folder_ / "boards");
  }
  static void TearDownTestSuite() { folder_.reset(); }
  static std::string place(const std::string& name) { return *folder_ / name; }
  static inline std::unique_ptr<TempFolder> folder_;
};

TEST_F(CalibrateLens, TakesAPatternInQuotesAndSaysWhichPicturesItLeftOut) {
  const Finished finished =
      runPatina({"calibrate", "lens", place("boards/*.png"), "--board", "7x5", "--radial", "0",
                 "--no-tangential", "--square-pixels", "--json", "--out", place("lens.json")});
  EXPECT_THAT(finished.err, HasSubstr("left out, the board is not seen in it: e.png"));
  const JsonAnswer answer = answerOf(finished);
  EXPECT_NEAR(answer.number("/items/0/fx"), 400, 4);
  EXPECT_GT(answer.number("/items/0/fx_sd"), 0);
  EXPECT_LT(answer.number("/items/0/rms_px"), 0.1);
  EXPECT_EQ(answer.text("/items/0/left_out/0"), "e.png");
  EXPECT_EQ(answer.size("/items"), 6u) << "the lens and its five pictures";
  EXPECT_EQ(answer.text("/items/1/view"), "a.png");
  EXPECT_NEAR(answer.number("/items/1/tilt_deg"), 20, 1);
  EXPECT_TRUE(std::filesystem::exists(place("lens.json")));
}

TEST_F(CalibrateLens, RefusesABoardOfAnotherSizeAndNoBoardAtAll) {
  const Finished other = runPatina({"calibrate", "lens", place("boards"), "--board", "8x6"});
  EXPECT_EQ(other.exit, 65);
  EXPECT_THAT(other.err, HasSubstr("give --board 7x5"));
  EXPECT_EQ(runPatina({"calibrate", "lens", place("boards")}).exit, 64);
  EXPECT_EQ(runPatina({"calibrate", "lens", place("none*.jpg"), "--board", "7x5"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
