// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/film_file.h"
#include "processing/image/picture_file.h"
#include "tests/capture/app/json_answer.h"

namespace patina::testing {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

const std::string kScene = R"(
size = "32x24"
samples = 4
[camera]
from_mm = [0, -60, 40]
[sky]
zenith = [1]
[[mesh]]
shape = "ball"
radius_mm = 12
colour = [0.7, 0.2, 0.1]
)";

class Render : public ::testing::Test {
 protected:
  Render() { writeFile(folder_ / "scene.toml", kScene); }
  Finished render(const std::string& scene, const std::string& out,
                  std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"render", folder_ / scene, "--out", folder_ / out});
    return runPatina(std::move(more));
  }
  TempFolder folder_ = TempFolder::inMemory();
};

TEST_F(Render, WritesAPictureOfTheScene) {
  const JsonAnswer answer = answerOf(render("scene.toml", "a.png", {"--json"}));
  EXPECT_EQ(answer.number("/items/0/width_px"), 32);
  EXPECT_EQ(answer.number("/items/0/samples"), 4);
  const Picture picture = readPicture(folder_ / "a.png");
  EXPECT_EQ(picture.linear.size(), (SizePx{32, 24}));
  EXPECT_GT(picture.linear.at(16, 8, 0), 2 * picture.linear.at(16, 8, 2));
}

TEST_F(Render, WritesTheSameBytesOnAnyNumberOfThreads) {
  for (const char* threads : {"1", "2", "8"})
    ASSERT_EQ(render("scene.toml", std::string(threads) + ".exr", {"--threads", threads}).exit, 0);
  EXPECT_EQ(readFile(folder_ / "1.exr"), readFile(folder_ / "2.exr"));
  EXPECT_EQ(readFile(folder_ / "1.exr"), readFile(folder_ / "8.exr"));
}

TEST_F(Render, WritesAFilmWithAStripBesideIt) {
  const Finished finished = render(
      "scene.toml", "a.mp4", {"--frames", "3", "--size", "16x16", "--strip", folder_ / "a.png"});
  ASSERT_EQ(finished.exit, 0) << finished.err;
  FilmReader reader(folder_ / "a.mp4");
  int frames = 0;
  while (reader.next()) ++frames;
  EXPECT_EQ(frames, 3);
  EXPECT_EQ(readPicture(folder_ / "a.png").linear.size(), (SizePx{5 * 16 + 4 * 2, 16}));
}

TEST_F(Render, SaysWhatIsWrongAndLeavesNothing) {
  writeFile(folder_ / "dark.toml", std::string(kScene).replace(kScene.find("[1]"), 3, "[0]"));
  Finished finished = render("dark.toml", "no.png");
  EXPECT_EQ(finished.exit, 78);
  EXPECT_THAT(finished.err, HasSubstr("no light"));
  EXPECT_EQ(render("none.toml", "no.png").exit, 74);
  EXPECT_EQ(render("scene.toml", "no.jpg").exit, 64);
  EXPECT_EQ(render("scene.toml", "no.mp4", {"--time", "0.5"}).exit, 64);
  EXPECT_EQ(render("scene.toml", "no.png", {"--time", "2"}).exit, 64);
  finished = render("", "no.png");
  EXPECT_EQ(finished.exit, 64);
  EXPECT_THAT(finished.err, HasSubstr("--top"));
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_.path()))
    EXPECT_EQ(entry.path().extension(), ".toml") << entry.path();
}

}  // namespace
}  // namespace patina::testing
