// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/film.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/film_file.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

TEST(FilmRate, MakesFilmsLastTenToTwentySeconds) {
  for (const std::int64_t frames : {12, 30, 68, 252, 600, 1008}) {
    const double seconds = static_cast<double>(frames) / filmRate(frames);
    EXPECT_GE(seconds, 10) << frames;
    EXPECT_LE(seconds, 20) << frames;
  }
  EXPECT_EQ(filmRate(1), 1);
  EXPECT_EQ(filmRate(120'960), 60);
}

class Film : public ::testing::Test {
 protected:
  Film() {
    run_ = testing::makeRun(folder_ / "archive",
                            std::vector<testing::MadeStep>(6, {{testing::MadeShot{}}}));
    sequence_ =
        sequenceOfRun(std::make_shared<const db::ArchiveReader>(folder_ / "archive"), run_, {}, {});
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::string run_;
  Sequence sequence_;
};

TEST_F(Film, HasEveryFrame) {
  Progress progress;
  const FilmOutcome outcome = makeFilm(sequence_, {}, folder_ / "x.mp4", progress);
  EXPECT_EQ(outcome.frames, 6);
  FilmReader reader(folder_ / "x.mp4");
  int frames = 0;
  while (reader.next()) ++frames;
  EXPECT_EQ(frames, 6);
}

TEST_F(Film, IsSmallerAtALowerQuality) {
  Progress progress;
  FilmRequest request;
  makeFilm(sequence_, request, folder_ / "good.mp4", progress);
  request.quality_crf = 45;
  makeFilm(sequence_, request, folder_ / "poor.mp4", progress);
  EXPECT_LT(std::filesystem::file_size(folder_ / "poor.mp4"),
            std::filesystem::file_size(folder_ / "good.mp4"));
}

TEST_F(Film, IsNotThereWhenItWasStopped) {
  Progress progress;
  progress.askToStop();
  EXPECT_THROW(makeFilm(sequence_, {}, folder_ / "x.mp4", progress), Stopped);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.mp4"));
}

TEST_F(Film, IsWrittenAsMp4Only) {
  Progress progress;
  EXPECT_THROW(makeFilm(sequence_, {}, folder_ / "x.avi", progress), WorkflowError);
}

}  // namespace
}  // namespace patina::workflow
