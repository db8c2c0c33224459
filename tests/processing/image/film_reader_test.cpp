// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/film_file.h"
#include "tests/processing/image/samples.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

struct Counted {
  int frames = 0;
  SizePx size;
  std::vector<double> times_s;
};

Counted countFrames(const std::filesystem::path& path) {
  FilmReader reader(path);
  Counted out;
  while (const auto frame = reader.next()) {
    ++out.frames;
    out.size = frame->size();
    if (reader.lastFrameTime()) out.times_s.push_back(toSeconds(*reader.lastFrameTime()));
  }
  EXPECT_FALSE(reader.next().has_value());
  return out;
}

TEST(FilmReader, FindsThe68FramesOfAFilmThatClaims444) {
  PATINA_TEST_DATA_OR_SKIP(path, "dynamic_texture/tree.avi");
  const Counted film = countFrames(path);
  EXPECT_EQ(film.frames, 68);
  EXPECT_EQ(film.size, (SizePx{320, 240}));
}

TEST(FilmReader, ReadsTheThirtyFramesOfAGif) {
  PATINA_TEST_DATA_OR_SKIP(path, "ivy_timelapse/timelapse.gif");
  const Counted film = countFrames(path);
  EXPECT_EQ(film.frames, 30);
  EXPECT_EQ(film.size, (SizePx{300, 480}));
  ASSERT_EQ(film.times_s.size(), 30u);
  EXPECT_EQ(film.times_s.front(), 0);
  EXPECT_TRUE(std::is_sorted(film.times_s.begin(), film.times_s.end()));
}

TEST(FilmReader, RefusesWhatIsNoFilm) {
  const TempFolder folder;
  testing::writeFile(folder / "empty.mp4", "");
  testing::writeFile(folder / "text.mp4", "this is not a film at all, whatever it is called");
  EXPECT_THAT(refusalOf([&] { FilmReader(folder / "empty.mp4"); }), HasSubstr("empty.mp4"));
  EXPECT_THAT(refusalOf([&] { FilmReader(folder / "text.mp4"); }), HasSubstr("not a film"));
  EXPECT_THAT(refusalOf([&] { FilmReader(folder / "absent.mp4"); }), HasSubstr("no such file"));
}

TEST(FilmReader, SurvivesDamage) {
  const TempFolder folder = TempFolder::inMemory();
  FilmWriter writer(folder / "good.mp4", {64, 48}, {});
  const auto frame = gradient(64, 48, 3);
  for (int i = 0; i < 5; ++i) writer.add(frame.view());
  writer.close();
  const std::string good = testing::readFile(folder / "good.mp4");
  int refused = 0;
  for (std::uint64_t i = 0; i < 60; ++i) {
    std::string bad = good;
    if (i % 2) {
      bad.resize(good.size() * i / 60);
    } else {
      bad[uniformBelow(hashSeed(1, i), bad.size())] ^= static_cast<char>(0x55);
    }
    testing::writeFile(folder / "bad.mp4", bad);
    try {
      countFrames(folder / "bad.mp4");
    } catch (const ProcessingError&) {
      ++refused;
    }
  }
  EXPECT_GE(refused, 25);
}

}  // namespace
}  // namespace patina
