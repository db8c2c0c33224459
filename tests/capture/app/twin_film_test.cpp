// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/film_file.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

double meanOf(const Image<std::uint8_t>& picture) {
  double sum = 0;
  for (const std::uint8_t v : picture.texels()) sum += v;
  return sum / static_cast<double>(picture.texels().size());
}

TEST(TwinFilm, ShowsTheWholeProcessWithOneExposure) {
  const TempFolder folder = TempFolder::inMemory();
  const JsonAnswer answer =
      answerOf(runPatina({"twin", "specimens", "film", "banana_ripening", "--out", folder / "b.mp4",
                          "--size", "48x32", "--frames", "6", "--rate", "12", "--json"}));
  EXPECT_EQ(answer.number("/items/0/frames"), 6);
  EXPECT_EQ(answer.number("/items/0/frames_per_second"), 12);
  FilmReader reader(folder / "b.mp4");
  std::vector<Image<std::uint8_t>> frames;
  while (auto frame = reader.next()) frames.push_back(std::move(*frame));
  ASSERT_EQ(frames.size(), 6u);
  EXPECT_EQ(frames[0].size(), (SizePx{48, 32}));
  EXPECT_LT(meanOf(frames[5]), 0.75 * meanOf(frames[2])) << "brown is darker than yellow";
}

TEST(TwinFilm, WritesAStripOfFiveTimesBesideIt) {
  const TempFolder folder = TempFolder::inMemory();
  const Finished finished =
      runPatina({"twin", "specimens", "film", "banana_ripening", "--out", folder / "b.mp4",
                 "--size", "64x32", "--frames", "3", "--strip", folder / "b.png"});
  EXPECT_EQ(finished.exit, 0) << finished.err;
  const Picture strip = readPicture(folder / "b.png");
  EXPECT_EQ(strip.linear.size(), (SizePx{5 * 64 + 4 * 2, 32}));
  EXPECT_EQ(strip.linear.at(64, 10), 1) << "the gap is white";
  EXPECT_GT(strip.linear.at(10, 16, 1), 1.5f * strip.linear.at(4 * 66 + 10, 16, 1));
}

TEST(TwinFilm, IsTheSameFilmAgain) {
  const TempFolder folder = TempFolder::inMemory();
  for (const char* name : {"a.mp4", "b.mp4"})
    answerOf(runPatina({"twin", "specimens", "film", "copper_patination", "--out", folder / name,
                        "--size", "32x32", "--frames", "4", "--seed", "7", "--json"}));
  EXPECT_EQ(readFile(folder / "a.mp4"), readFile(folder / "b.mp4"));
}

TEST(TwinFilm, AMistakeIsSaidAndLeavesNothing) {
  const TempFolder folder = TempFolder::inMemory();
  const auto mistaken = [&](std::vector<std::string> more, const std::string& said) {
    std::vector<std::string> command = {"twin", "specimens", "film"};
    command.insert(command.end(), more.begin(), more.end());
    const Finished finished = runPatina(command);
    EXPECT_EQ(finished.exit, 64) << said;
    EXPECT_THAT(finished.err, HasSubstr(said));
  };
  const std::string out = folder / "x.mp4";
  mistaken({"toast", "--out", out}, "banana_ripening");
  mistaken({"grey_card", "--out", folder / "x.gif"}, ".mp4");
  mistaken({"grey_card", "--out", out, "--strip", folder / "x.jpg"}, ".png");
  mistaken({"grey_card", "--out", out, "--light", "1,2"}, "x,y,z");
  mistaken({"grey_card", "--out", out, "--light", "1,2,-3"}, "at least 1 mm");
  mistaken({"grey_card", "--out", out, "--size", "8x8"}, "16x16");
  mistaken({"grey_card", "--out", out, "--frames", "1"}, "--frames");
  EXPECT_TRUE(fs::is_empty(fs::path(out).parent_path()));
}

}  // namespace
}  // namespace patina::testing
