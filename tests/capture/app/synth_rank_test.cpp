// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

TEST(SynthRank, TellsWhatFewComponentsLeaveOutAndDrawsIt) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string file = folder / "s.h5";
  ASSERT_EQ(runPatina({"twin", "specimens", "ttf", "steel_rusting", "--out", file, "--size",
                       "64x64", "--frames", "12"})
                .exit,
            0);
  const JsonAnswer answer = answerOf(runPatina({"synth", "rank", file, "--most", "12", "--block",
                                                "20x20", "--chart", folder / "c.png", "--json"}));
  double before = 1;
  for (int i = 0; i < 6; ++i) {  // ranks 1, 2, 3, 5, 8, 10
    const std::string item = "/items/" + std::to_string(i);
    const double error = answer.number(item + "/error");
    EXPECT_LT(error, before);
    before = error;
    EXPECT_GE(answer.number(item + "/regret"), 0);
  }
  EXPECT_LT(answer.number("/items/5/regret"), answer.number("/items/0/regret"));
  EXPECT_EQ(readPicture(folder / "c.png").linear.width(), 1200);
  EXPECT_EQ(runPatina({"synth", "rank", file, "--chart", folder / "c.gif"}).exit, 64);
}

}  // namespace
}  // namespace patina::testing
