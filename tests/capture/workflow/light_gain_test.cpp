// SPDX-License-Identifier: GPL-3.0-or-later
// One gain a frame and channel, from a region that does not change: planted, and on a real
// time-lapse.
#include "capture/workflow/light_gain.h"

#include <gmock/gmock.h>

#include <cmath>

#include "calibration/failure.h"
#include "calibration/light/light_statistics.h"
#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"
#include "tests/support/places.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::TempFolder;

LightGainOutcome measure(const std::filesystem::path& archive, const std::string& run,
                         RectPx patch) {
  LightGainRequest request;
  request.run = run;
  request.patch = patch;
  request.command = "patina light measure";
  request.version = "test";
  Progress progress;
  return measureLightGain(archive, request, testing::now(), progress);
}

// Levels of a region in every frame, corrected or not.
std::vector<std::array<double, 3>> levelsOf(const std::filesystem::path& archive,
                                            const std::string& run, RectPx region, int every,
                                            bool corrected) {
  const db::ArchiveReader reader(archive);
  FrameSelection selection;
  selection.every = every;
  ArchiveFrames frames(reader, run, selection, {.light_gain = corrected});
  std::vector<std::array<double, 3>> levels;
  while (const auto frame = frames.next())
    levels.push_back(calibration::measurePatch(frame->linear.view(), region).level);
  return levels;
}
double flicker(const std::vector<std::array<double, 3>>& levels, std::size_t channel) {
  double sum = 0, squares = 0;
  for (const auto& level : levels) sum += level[channel];
  const double mean = sum / static_cast<double>(levels.size());
  for (const auto& level : levels) squares += std::pow(level[channel] / mean - 1, 2);
  return std::sqrt(squares / static_cast<double>(levels.size()));
}

struct Lapse {
  TempFolder folder = TempFolder::inMemory();
  std::filesystem::path archive = folder / "archive";
  std::string run;
  explicit Lapse(int frames = 5) {
    testing::plantPngs(folder / "in", frames);
    run = testing::import(testing::importOf(folder / "in", archive)).run_id;
  }
};

TEST(LightGain, MakesTheRegionTheSameInAllFramesAndBindsItselfToThem) {
  Lapse lapse;
  const LightGainOutcome outcome = measure(lapse.archive, lapse.run, {2, 2, 8, 8});
  EXPECT_EQ(outcome.frames, 5);
  EXPECT_EQ(outcome.row.kind, "light_gain");
  EXPECT_GT(outcome.flicker[1], 0.2);
  EXPECT_GT(flicker(levelsOf(lapse.archive, lapse.run, {12, 4, 8, 8}, 1, false), 1), 0.2);
  EXPECT_LT(flicker(levelsOf(lapse.archive, lapse.run, {12, 4, 8, 8}, 1, true), 1), 1e-5);
  const db::ArchiveReader reader(lapse.archive);
  EXPECT_EQ(
      lightGainsOf(reader, lapse.run, outcome.row.device_id, outcome.row.light_state).gains.size(),
      5u);
  EXPECT_TRUE(lightGainsOf(reader, lapse.run, "another", outcome.row.light_state).gains.empty());
}

TEST(LightGain, IsThatOfTheNewestMeasurement) {
  Lapse lapse;
  measure(lapse.archive, lapse.run, {2, 2, 8, 8});
  const LightGainOutcome second = measure(lapse.archive, lapse.run, {12, 4, 8, 8});
  EXPECT_EQ(db::ArchiveReader(lapse.archive).calibrations("light_gain").size(), 2u);
  EXPECT_EQ(second.path.filename(), "gains.json");
}

TEST(LightGain, RefusesARegionThatIsClippedDarkOrOutside) {
  TempFolder folder = TempFolder::inMemory();
  std::filesystem::create_directories(folder / "in");
  testing::plantPng(folder / "in" / "a.png", {24, 16}, 255);
  testing::plantPng(folder / "in" / "b.png", {24, 16}, 0);
  const std::string run =
      testing::import(testing::importOf(folder / "in", folder / "archive")).run_id;
  EXPECT_THROW(measure(folder / "archive", run, {2, 2, 8, 8}), WorkflowError);
  EXPECT_THROW(measure(folder / "archive", run, {20, 2, 8, 8}), calibration::CalibrationError);
  EXPECT_TRUE(db::ArchiveReader(folder / "archive").calibrations("light_gain").empty());
}

// Gain from the ceiling's left, flicker on its right, 80 pixels away; frames come in pairs, so one
// of each is used. The file's 256 colours a frame bend tones apart: only regions of about the same
// tone answer for one another, and a darker wall is printed beside it.
TEST(LightGain, CalmsARealTimeLapseOnARegionThatDidNotGiveTheGain) {
  PATINA_TEST_DATA_OR_SKIP(data, "ivy_timelapse/timelapse.gif");
  TempFolder folder = TempFolder::inMemory();
  const std::string run = testing::import(testing::importOf(data, folder / "archive")).run_id;
  const RectPx gives{10, 40, 100, 40}, judged{190, 30, 100, 40}, darker{215, 195, 40, 70};
  measure(folder / "archive", run, gives);
  for (const auto& [name, region] :
       {std::pair{"judged", judged}, std::pair{"darker wall", darker}}) {
    const auto as_shot = levelsOf(folder / "archive", run, region, 2, false);
    const auto corrected = levelsOf(folder / "archive", run, region, 2, true);
    for (std::size_t c = 0; c < 3; ++c) {
      const double before = flicker(as_shot, c), after = flicker(corrected, c);
      std::printf("ivy, %s, %c: flicker %.3f %% before, %.3f %% after: %.1f times less\n", name,
                  "rgb"[c], 100 * before, 100 * after, before / after);
      if (name == std::string("judged")) {
        EXPECT_GE(before / after, 3);
      }
    }
  }
}

}  // namespace
}  // namespace patina::workflow
