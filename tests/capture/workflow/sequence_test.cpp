// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sequence.h"

#include <gmock/gmock.h>

#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::TempFolder;

// Ten frames of 16x16 that brighten from 0.02 to 0.2.
std::filesystem::path plantTtf(const TempFolder& folder, const std::string& provenance) {
  ttf::TtfInfo info;
  info.width = info.height = 16;
  info.provenance_json = provenance;
  ttf::TtfWriter writer(folder / "x.h5", info);
  for (int t = 0; t < 10; ++t) {
    const Image<float> frame(16, 16, 3, 0.02f * static_cast<float>(t + 1));
    writer.add(frame.view(), t * 60.0, Sha256{});
  }
  writer.close();
  return folder / "x.h5";
}

TEST(SequenceOfTtf, GivesEveryNthFrameAgainAndAgain) {
  const TempFolder folder = TempFolder::inMemory();
  const Sequence sequence = sequenceOfTtf(plantTtf(folder, ""));
  for (int round = 0; round < 2; ++round) {
    const auto source = sequence.open(4);
    EXPECT_EQ(source->count(), 3);
    std::vector<double> times;
    while (const auto frame = source->next()) times.push_back(frame->time_s);
    EXPECT_THAT(times, ::testing::ElementsAre(0, 240, 480));
  }
}

TEST(DisplayGain, BringsLinearFramesToNineTenths) {
  const TempFolder folder = TempFolder::inMemory();
  Progress progress;
  EXPECT_NEAR(displayGain(sequenceOfTtf(plantTtf(folder, "")), progress), 0.9 / 0.2, 0.05);
}

TEST(DisplayGain, LeavesPicturesThatWereMadeForTheEyeAlone) {
  const TempFolder folder = TempFolder::inMemory();
  Progress progress;
  const auto file = plantTtf(folder, R"({"options.display_referred":true})");
  EXPECT_EQ(displayGain(sequenceOfTtf(file), progress), 1);
}

TEST(SequenceOfTtf, TakesAnotherProgramsProvenance) {
  const TempFolder folder = TempFolder::inMemory();
  EXPECT_FALSE(sequenceOfTtf(plantTtf(folder, "made by hand")).display_referred);
}

TEST(SequenceOfRun, OfJpegAndPngIsDisplayReferred) {
  const TempFolder folder = TempFolder::inMemory();
  const std::string run = testing::makeRun(folder.path(), {{{testing::MadeShot{}}}});
  const auto reader = std::make_shared<const db::ArchiveReader>(folder.path());
  const Sequence sequence = sequenceOfRun(reader, run, {}, {});
  EXPECT_TRUE(sequence.display_referred);
  EXPECT_EQ(sequence.frames, 1);
  const auto frame = sequence.open(1)->next();
  EXPECT_EQ(toDisplay(frame->linear.view(), 1).at(5, 5, 1), 100);
}

TEST(ToDisplay, SpreadsAGreyPictureOverThreeChannels) {
  const Image<float> grey(4, 3, 1, 0.25f);
  const Image<std::uint8_t> shown = toDisplay(grey.view(), 2);
  EXPECT_EQ(shown.channels(), 3);
  EXPECT_EQ(shown.at(1, 1, 2), std::lround(255 * srgbFromLinear(0.5f)));
}

}  // namespace
}  // namespace patina::workflow
