// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/archive_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using testing::check;
using testing::MadeShot;
using testing::MadeStep;
using testing::makeRun;
using testing::TempFolder;

class ArchiveFramesOf : public ::testing::Test {
 protected:
  std::vector<ttf::SourceFrame> all(const FrameSelection& selection = {},
                                    const Correction& correction = {}) {
    const db::ArchiveReader reader(folder_.path());
    ArchiveFrames frames(reader, reader.runs().back().id, selection, correction);
    std::vector<ttf::SourceFrame> taken;
    while (auto frame = frames.next()) taken.push_back(std::move(*frame));
    EXPECT_EQ(static_cast<std::int64_t>(taken.size()), frames.count());
    report_ = frames.report();
    return taken;
  }
  std::string refusal(const FrameSelection& selection = {}) {
    try {
      all(selection);
    } catch (const WorkflowError& error) {
      EXPECT_EQ(error.exit(), Exit::kUsage);
      return error.what();
    }
    return "not refused";
  }
  TempFolder folder_ = TempFolder::inMemory();
  FramesReport report_;
};

TEST_F(ArchiveFramesOf, ComeInOrderOfTimeWithTheirHashes) {
  makeRun(folder_.path(), std::vector<MadeStep>(40, MadeStep{{MadeShot{}}}));
  const auto frames = all();
  ASSERT_EQ(frames.size(), 40u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_DOUBLE_EQ(frames[i].time_s, 600.0 * static_cast<double>(i));
    EXPECT_EQ(frames[i].source.hex(), report_.input_sha256s[i]);
  }
  EXPECT_EQ(all({.every = 4}).size(), 10u);
}

TEST_F(ArchiveFramesOf, SeveralLightsAreRefusedWithTheChoices) {
  MadeShot key, fill;
  fill.light = "fill";
  makeRun(folder_.path(), {{{key, fill}}});
  EXPECT_THAT(refusal(),
              ::testing::AllOf(::testing::HasSubstr("--light"), ::testing::HasSubstr("fill, key")));
  EXPECT_THAT(refusal({.light = "moon"}), ::testing::HasSubstr("no light state 'moon'"));
  EXPECT_EQ(all({.light = "fill"}).size(), 1u);
}

TEST_F(ArchiveFramesOf, SeveralCamerasAndExposuresAreRefusedToo) {
  MadeShot one, other;
  other.camera = "cam1";
  other.exposure = 1;
  makeRun(folder_.path(), {{{one, other}}});
  EXPECT_THAT(refusal(), ::testing::HasSubstr("cam0, cam1"));
  EXPECT_THAT(refusal({.camera = "cam0"}), ::testing::HasSubstr("--exposure: 0, 1"));
  EXPECT_EQ(all({.camera = "cam0", .exposure = 0}).size(), 1u);
}

TEST_F(ArchiveFramesOf, StepsThatAreNotWholeAreLeftOutUnlessWanted) {
  makeRun(folder_.path(), {{{MadeShot{}}}, {{MadeShot{}}, 2}, {{MadeShot{}}}});
  EXPECT_EQ(all().size(), 2u);
  EXPECT_EQ(report_.steps_partial_left_out, 1);
  EXPECT_EQ(all({.partial = true}).size(), 3u);
}

TEST_F(ArchiveFramesOf, GainsUndoTheLightsDriftPerChannel) {
  MadeShot shot;
  shot.checks = {check("r", 0.8, "correct", 1.25), check("g", 1.0, "pass"),
                 check("b", 2.0, "correct", 0.5)};
  makeRun(folder_.path(), {{{shot}}});
  const float level = linearFromSrgb(100.0f / 255);
  const auto frames = all();
  EXPECT_NEAR(frames[0].linear.at(3, 3, 0), 1.25f * level, 1e-6);
  EXPECT_NEAR(frames[0].linear.at(3, 3, 1), level, 1e-6);
  EXPECT_NEAR(frames[0].linear.at(3, 3, 2), 0.5f * level, 1e-6);
  EXPECT_DOUBLE_EQ(report_.gain_max, 1.25);
  const auto untouched = all({}, {false, false, false});
  EXPECT_NEAR(untouched[0].linear.at(3, 3, 0), level, 1e-6);
}

TEST_F(ArchiveFramesOf, AHeldVerdictGivesNoGain) {
  MadeShot shot;
  shot.checks = {check("r", 0.1, "hold", 10)};
  makeRun(folder_.path(), {{{shot}}});
  EXPECT_NEAR(all()[0].linear.at(0, 0, 0), linearFromSrgb(100.0f / 255), 1e-6);
}

TEST_F(ArchiveFramesOf, UnequalSizesAreCutAboutTheCentre) {
  MadeShot large;
  large.size = {26, 19};
  makeRun(folder_.path(), {{{MadeShot{}}}, {{large}}});
  for (const auto& frame : all()) EXPECT_EQ(frame.linear.size(), (SizePx{24, 16}));
  EXPECT_EQ(report_.sizes, 2);
  EXPECT_EQ(report_.largest, (SizePx{26, 19}));
}

TEST_F(ArchiveFramesOf, AChangedFileIsNoticed) {
  makeRun(folder_.path(), {{{MadeShot{}}}});
  const db::ArchiveReader reader(folder_.path());
  std::filesystem::path file;
  reader.eachFrame(reader.runs().back().id,
                   [&](const auto& one) { file = reader.pathOf(one.frame); });
  std::filesystem::permissions(file, std::filesystem::perms::owner_all);
  testing::writeFile(file, testing::readFile(file) + "x");
  EXPECT_THROW(all(), Failure);
}

}  // namespace
}  // namespace patina::workflow
