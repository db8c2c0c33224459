// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/capture/app/json_answer.h"
#include "tests/capture/workflow/drawn_board.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina::testing {
namespace {

TEST(CalibrateVignetting, SaysWhatTheLensLeavesInTheCorners) {
  const TempFolder folder = TempFolder::inMemory();
  DrawnBoard white;
  white.columns = white.rows = 0;
  white.falloff = 0.25;
  plantBoard(folder / "flat.png", white);
  const JsonAnswer answer = answerOf(
      runPatina({"calibrate", "vignetting", folder / "flat.png", "--terms", "1", "--json"}));
  EXPECT_NEAR(answer.number("/items/0/corner"), 0.75, 0.005);
  EXPECT_EQ(answer.number("/items/0/pictures"), 1);
}

}  // namespace
}  // namespace patina::testing
