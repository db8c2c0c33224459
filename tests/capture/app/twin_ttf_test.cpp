// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "processing/ttf/ttf_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

TEST(TwinTtf, HoldsTheWholeProcessInSixteenBitsOrEight) {
  const TempFolder folder = TempFolder::inMemory();
  for (const bool encoded : {false, true}) {
    std::vector<std::string> command{
        "twin",  "specimens", "ttf", "banana_ripening", "--out", folder / "b.h5", "--size",
        "48x32", "--frames",  "5",   "--json"};
    if (encoded) command.push_back("--encoded");
    EXPECT_EQ(answerOf(runPatina(command)).number("/items/0/frames"), 5);
    const ttf::TtfReader reader(folder / "b.h5");
    EXPECT_EQ(reader.info().type, encoded ? ttf::SampleType::kU8 : ttf::SampleType::kU16);
    EXPECT_EQ(reader.info().width, 48);
    const Image<float> first = reader.linearFrame(0), last = reader.linearFrame(4);
    double green = 0, late = 0;
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x) {
        green += first.at(x, y, 1);
        late += last.at(x, y, 1);
      }
    EXPECT_LT(late, 0.8 * green);  // it turns brown
  }
}

TEST(TwinTtf, RefusesASizeItCannotDraw) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_EQ(runPatina({"twin", "specimens", "ttf", "banana_ripening", "--size", "8x8", "--out",
                       folder / "b.h5"})
                .exit,
            64);
  EXPECT_FALSE(std::filesystem::exists(folder / "b.h5"));
}

}  // namespace
}  // namespace patina::testing
