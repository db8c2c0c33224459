// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "processing/image/film_file.h"
#include "processing/image/sha256.h"
#include "tests/processing/image/samples.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

namespace fs = std::filesystem;
using testing::TempFolder;

std::vector<Image<std::uint8_t>> framesOf(const fs::path& path) {
  FilmReader reader(path);
  std::vector<Image<std::uint8_t>> out;
  while (auto frame = reader.next()) out.push_back(std::move(*frame));
  return out;
}

// Colours drift, and a square moves.
Image<std::uint8_t> frameAt(int t, SizePx size) {
  Image<std::uint8_t> out(size.width, size.height, 3);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      for (int c = 0; c < 3; ++c)
        out.at(x, y, c) = static_cast<std::uint8_t>(40 + 50 * c + 2 * t + (x * 40) / size.width);
  for (int y = 8; y < 24; ++y)
    for (int x = 4 + t; x < 20 + t; ++x) out.at(x, y, 1) = 220;
  return out;
}

void writeFilm(const fs::path& path, SizePx size, int frames, const FilmOptions& options = {}) {
  FilmWriter writer(path, size, options);
  for (int t = 0; t < frames; ++t) writer.add(frameAt(t, size).view());
  writer.close();
}

TEST(FilmWriter, KeepsFrameCountTimesAndColours) {
  const TempFolder folder = TempFolder::inMemory();
  writeFilm(folder / "a.mp4", {96, 64}, 12, {.frames_per_second = 12.5, .quality_crf = 10});
  FilmReader reader(folder / "a.mp4");
  std::array<double, 3> bias{};
  for (int t = 0; t < 12; ++t) {
    const auto frame = reader.next();
    ASSERT_TRUE(frame.has_value());
    EXPECT_NEAR(toSeconds(*reader.lastFrameTime()), t * 0.08, 1e-3);
    const auto want = frameAt(t, {96, 64});
    for (int y = 32; y < 64; ++y)
      for (int x = 0; x < 96; ++x)
        for (int c = 0; c < 3; ++c) bias[c] += frame->at(x, y, c) - want.at(x, y, c);
  }
  EXPECT_FALSE(reader.next().has_value());
  for (double b : bias) EXPECT_LT(std::abs(b / (12 * 32 * 96)), 1.0);
}

TEST(FilmWriter, PadsOddSizesByRepeatingTheLastRowAndColumn) {
  const TempFolder folder = TempFolder::inMemory();
  writeFilm(folder / "a.mp4", {65, 49}, 3, {.quality_crf = 1});
  const auto frames = framesOf(folder / "a.mp4");
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_EQ(frames[0].size(), (SizePx{66, 50}));
  const auto want = frameAt(0, {65, 49});
  EXPECT_NEAR(frames[0].at(65, 30, 1), want.at(64, 30, 1), 4);
  EXPECT_NEAR(frames[0].at(30, 49, 1), want.at(30, 48, 1), 4);
}

TEST(FilmWriter, GivesTheSameFramesForAnyNumberOfThreads) {
  const TempFolder folder = TempFolder::inMemory();
  writeFilm(folder / "many.mp4", {128, 96}, 40);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    writeFilm(folder / "one.mp4", {128, 96}, 40);
  }
  const auto many = framesOf(folder / "many.mp4"), one = framesOf(folder / "one.mp4");
  ASSERT_EQ(many.size(), one.size());
  for (std::size_t t = 0; t < many.size(); ++t)
    ASSERT_EQ(many[t].texels(), one[t].texels()) << "frame " << t;
}

TEST(FilmWriter, LeavesNothingUnlessClosed) {
  const TempFolder folder = TempFolder::inMemory();
  {
    FilmWriter writer(folder / "a.mp4", {64, 48}, {});
    writer.add(frameAt(0, {64, 48}).view());
    EXPECT_FALSE(fs::exists(folder / "a.mp4"));
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(FilmWriter, RefusesBadOptionsAndPlaces) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_THROW(FilmWriter(folder / "a.mp4", {0, 48}, {}), ProcessingError);
  EXPECT_THROW(FilmWriter(folder / "a.mp4", {64, 48}, {.frames_per_second = 0}), ProcessingError);
  EXPECT_THROW(FilmWriter(folder / "a.mp4", {64, 48}, {.quality_crf = 99}), ProcessingError);
  EXPECT_THROW(FilmWriter(folder / "none" / "a.mp4", {64, 48}, {}), ProcessingError);
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(FilmWriter, PutsTheIndexFirstSoThatFilmsStartAtOnce) {
  const TempFolder folder = TempFolder::inMemory();
  writeFilm(folder / "a.mp4", {64, 48}, 3);
  const std::string bytes = testing::readFile(folder / "a.mp4");
  EXPECT_LT(bytes.find("moov"), bytes.find("mdat"));
}

}  // namespace
}  // namespace patina
