// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/pictures.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

TEST(SpreadEvenly, TakesFirstAndLastOfFewFramesAndNoneTwice) {
  EXPECT_THAT(spreadEvenly(5, 24), ::testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(spreadEvenly(10, 4), ::testing::ElementsAre(0, 3, 6, 9));
  EXPECT_THAT(spreadEvenly(30, 3), ::testing::ElementsAre(0, 14, 28));
  EXPECT_THAT(spreadEvenly(1, 24), ::testing::ElementsAre(0));
  EXPECT_TRUE(spreadEvenly(0, 24).empty());
  for (int frames = 1; frames < 200; ++frames)
    for (int wanted = 1; wanted < 30; ++wanted) {
      const auto indices = spreadEvenly(frames, wanted);
      ASSERT_EQ(static_cast<int>(indices.size()), std::min(frames, wanted));
      for (std::size_t i = 1; i < indices.size(); ++i) ASSERT_LT(indices[i - 1], indices[i]);
      ASSERT_LT(indices.back(), frames);
    }
}

class Pictures : public ::testing::Test {
 protected:
  Pictures() {
    std::vector<testing::MadeStep> steps;
    for (int k = 0; k < 9; ++k) steps.push_back({{testing::MadeShot{.level = 40 + 20 * k}}});
    run_ = testing::makeRun(folder_.path(), steps);
    sequence_ =
        sequenceOfRun(std::make_shared<const db::ArchiveReader>(folder_.path()), run_, {}, {});
  }
  TempFolder folder_ = TempFolder::inMemory();
  std::string run_;
  Sequence sequence_;
  Progress progress_;
};

bool shows(const Image<std::uint8_t>& picture, int level) {
  const auto& texels = picture.texels();
  for (std::size_t i = 0; i + 2 < texels.size(); i += 3)
    if (texels[i] == level && texels[i + 1] == level && texels[i + 2] == level) return true;
  return false;
}

TEST_F(Pictures, ASheetShowsFirstAndLast) {
  const Image<std::uint8_t> sheet = makeSheet(sequence_, {.cells = 3}, progress_);
  EXPECT_TRUE(shows(sheet, 40));
  EXPECT_TRUE(shows(sheet, 40 + 20 * 8));
  EXPECT_FALSE(shows(sheet, 40 + 20 * 3));
}

TEST_F(Pictures, ASheetOfARegionIsShapedLikeItAndOneBeyondTheFramesIsRefused) {
  const auto whole = makeSheet(sequence_, {.cells = 2, .columns = 2}, progress_);
  const auto part =
      makeSheet(sequence_, {.cells = 2, .columns = 2, .region = RectPx{2, 1, 16, 4}}, progress_);
  EXPECT_TRUE(shows(part, 40));
  EXPECT_LT(part.height(), whole.height());
  for (const RectPx wrong : {RectPx{0, 0, 25, 4}, RectPx{-1, 0, 4, 4}, RectPx{0, 0, 0, 4}})
    EXPECT_THROW(makeSheet(sequence_, {.region = wrong}, progress_), WorkflowError);
}

TEST_F(Pictures, AKeogramShowsEveryFrame) {
  const Image<std::uint8_t> keogram = makeKeogram(sequence_, {}, progress_);
  for (int k = 0; k < 9; ++k) EXPECT_TRUE(shows(keogram, 40 + 20 * k)) << k;
}

TEST_F(Pictures, AKeogramOfAColumnThatIsNotThereIsRefused) {
  EXPECT_THROW(makeKeogram(sequence_, {.column = 24}, progress_), WorkflowError);
}

TEST_F(Pictures, APlateHasARowASpecimen) {
  const auto one = makePlate({{"moss", "", sequence_}}, 3, 40, progress_);
  const auto two = makePlate({{"moss", "", sequence_}, {"fern", "", sequence_}}, 3, 40, progress_);
  EXPECT_EQ(one.width(), two.width());
  EXPECT_GT(two.height(), one.height());
}

TEST_F(Pictures, AChartOfNoLightSaysSoInsteadOfFailing) {
  LightReport report;
  report.run_id = "empty";
  EXPECT_FALSE(drawLight(report).empty());
}

TEST_F(Pictures, AChartOfLightShowsLevelsAndNotThePicturesTiles) {
  LightReport report;
  report.run_id = "lit";
  LightSeriesReport patch;
  patch.light = "key";
  patch.source = "patch:cam0";
  patch.time_s = {0, 60, 120};
  patch.ratio = {1, 1.01, 1};
  patch.verdict = {"pass", "pass", "pass"};
  report.series = {patch};
  const auto levels = drawLight(report).texels();
  LightSeriesReport tiles = patch;
  tiles.source = "content:cam0";
  tiles.ratio = {0.7, 0.9, 1.3};
  report.series.push_back(tiles);
  EXPECT_EQ(drawLight(report).texels(), levels);
  report.series.back().source = "sensor:lux0";
  EXPECT_NE(drawLight(report).texels(), levels);
}

}  // namespace
}  // namespace patina::workflow
