// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/film_file.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/rehearsed.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;

class FilmAndSheet : public Rehearsed {};

TEST_F(FilmAndSheet, TakeATextureByFileOrIdAndARun) {
  const std::string id = answer({"ttf", "list"}).text("/items/0/id");
  const std::string file = answer({"ttf", "list"}).text("/items/0/path");
  for (const std::string& in : {id, file, std::string("latest")}) {
    EXPECT_EQ(answer({"film", in, place("x.mp4"), "--fps", "12"}).number("/items/0/frames"), 12);
    FilmReader reader(place("x.mp4"));
    int frames = 0;
    while (reader.next()) ++frames;
    EXPECT_EQ(frames, 12) << in;
  }
}

TEST_F(FilmAndSheet, SheetAndKeogramArePictures) {
  answer({"sheet", "latest", place("sheet.png"), "--cells", "4"});
  answer({"keogram", "latest", place("keogram.png"), "--column", "10"});
  EXPECT_GT(readPicture(place("sheet.png")).linear.width(), 300);
  EXPECT_GT(readPicture(place("keogram.png")).linear.width(), 300);
  EXPECT_EQ(patina({"keogram", "latest", place("no.png"), "--column", "9999"}).exit, 64);
  EXPECT_FALSE(std::filesystem::exists(place("no.png")));
}

TEST_F(FilmAndSheet, LightReportSpeaksAndDraws) {
  const Finished finished = patina({"light", "report", "--out", place("light.png")});
  EXPECT_EQ(finished.exit, 0) << finished.err;
  EXPECT_THAT(finished.out, HasSubstr("light checks"));
  EXPECT_GT(readPicture(place("light.png")).linear.width(), 300);
  EXPECT_GT(answer({"light", "report"}).number("/items/0/checks"), 0);
}

}  // namespace
}  // namespace patina::testing
