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

// A sweep of two exposures: `ratio` of light between them as the pictures have it.
MadeStep swept(int short_level, int long_level, double gain = 1) {
  MadeShot brief, longer;
  brief.exposure = 1;
  brief.level = short_level;
  brief.exposed = std::chrono::milliseconds(10);
  longer.level = long_level;
  longer.exposed = std::chrono::milliseconds(40);
  if (gain != 1) brief.checks = longer.checks = {check("g", 1 / gain, "correct", gain)};
  return {{longer, brief}};
}

TEST_F(ArchiveFramesOf, ExposuresOfAStepAreMergedAndScaledAsTheShortest) {
  // Four times the light in the second one, by sRGB's curve; the last step's is white there.
  const auto levelOf = [](float linear) {
    return static_cast<int>(std::lround(255 * srgbFromLinear(linear)));
  };
  const float dim = linearFromSrgb(60 / 255.0f), bright = linearFromSrgb(180 / 255.0f);
  makeRun(folder_.path(), {swept(60, levelOf(4 * dim)), swept(180, 255, 1.1), swept(255, 255)});
  const auto frames = all({.merged = true});
  ASSERT_EQ(frames.size(), 3u);
  EXPECT_NEAR(frames[0].linear.at(5, 5, 1), dim, 0.01 * dim);
  EXPECT_NEAR(frames[1].linear.at(5, 5, 1), bright * 1.1, 1e-3) << "the long one is white: not it";
  EXPECT_GE(frames[2].linear.at(5, 5, 1), 1) << "white in both";
  EXPECT_EQ(report_.saturated_samples, 24 * 16 * 3);
  EXPECT_EQ(report_.exposures, 2);
  EXPECT_EQ(report_.exposure, 1);
  EXPECT_EQ(report_.exposure_time, std::chrono::milliseconds(10));
  EXPECT_EQ(report_.input_sha256s.size(), 6u);
  EXPECT_THAT(report_.masters_left,
              ::testing::ElementsAre(::testing::HasSubstr("calibrate noise")));
}

TEST_F(ArchiveFramesOf, WhatEveryExposureClipsIsNotKnownWhereThatIsWanted) {
  makeRun(folder_.path(), {swept(180, 255), swept(255, 255)});
  const auto frames = all({.merged = true}, {.clipped = Clipped::kUnknown});
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_GT(frames[0].linear.at(5, 5, 1), 0) << "the short one tells";
  EXPECT_TRUE(std::isnan(frames[1].linear.at(5, 5, 1)));
}

TEST_F(ArchiveFramesOf, ExposuresAsShortAsTheShortestAreCounted) {
  MadeStep step = swept(60, 100);
  MadeShot again = step.shots[1];
  again.exposure = 2;
  step.shots.push_back(again);
  makeRun(folder_.path(), {step});
  EXPECT_EQ(all({.merged = true}).size(), 1u);
  EXPECT_EQ(report_.exposures, 3);
  EXPECT_EQ(report_.as_short, 2);
}

TEST_F(ArchiveFramesOf, AStepThatLacksAnExposureIsNotMerged) {
  MadeStep lacking = swept(60, 100);
  lacking.shots.pop_back();
  makeRun(folder_.path(), {swept(60, 100), lacking});
  EXPECT_EQ(all({.merged = true}).size(), 1u);
  EXPECT_EQ(report_.steps_partial_left_out, 1);
}

TEST_F(ArchiveFramesOf, OneExposureIsNothingToMerge) {
  makeRun(folder_.path(), {{{MadeShot{}}}});
  EXPECT_THAT(refusal({.merged = true}), ::testing::HasSubstr("nothing to merge"));
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

class HeldToAPatch : public ArchiveFramesOf {
 protected:
  // Levels of green in the middle of frames whose light was calibrated with this level of green.
  std::vector<float> greens(double calibrated, const FrameSelection& selection = {}) {
    const db::ArchiveReader reader(folder_.path());
    ArchiveFrames frames(reader, reader.runs().back().id, selection, {});
    why_not_ = frames.holdToPatch({0.5, calibrated, 0.5});
    std::vector<float> found;
    while (const auto frame = frames.next()) found.push_back(frame->linear.at(3, 3, 1) / kOne);
    report_ = frames.report();
    return found;
  }
  static std::vector<db::LightCheckRow> patch(double green, const char* verdict = "learn") {
    std::vector<db::LightCheckRow> rows{check("r", 1, verdict), check("g", green, verdict),
                                        check("b", 1, verdict)};
    for (db::LightCheckRow& row : rows) row.baseline = 0;
    return rows;
  }
  const float kOne = linearFromSrgb(100.0f / 255);
  std::string why_not_;
};

TEST_F(HeldToAPatch, AreAsBrightAsWhenTheirLightWasCalibrated) {
  MadeShot first, second;
  first.checks = patch(1.002), second.checks = patch(0.98);
  makeRun(folder_.path(), {{{first}}, {{second}}});
  const auto found = greens(0.49);
  EXPECT_NEAR(found[0], 0.98 / 1.002, 1e-5);
  EXPECT_NEAR(found[1], 1, 1e-5);
  EXPECT_TRUE(report_.held_to_patch);
}

TEST_F(HeldToAPatch, LongerExposuresByTheirShareAndByTheShortestWhereTheyClipIt) {
  for (const char* verdict : {"learn", "saturated"}) {
    MadeStep step = swept(100, 190);
    step.shots[0].checks = {check("y", verdict[0] == 's' ? 2 : 0.8 * 0.98, verdict)};
    step.shots[1].checks = {check("y", 0.2 * 0.98, "learn")};
    for (MadeShot& shot : step.shots) shot.checks[0].baseline = 0;
    const TempFolder folder = TempFolder::inMemory();
    makeRun(folder.path(), {step});
    const db::ArchiveReader reader(folder.path());
    ArchiveFrames frames(reader, reader.runs().back().id, {.merged = true}, {});
    EXPECT_EQ(frames.holdToPatch({0.1, 0.1, 0.1}), "");
    frames.next();
    EXPECT_NEAR(frames.report().gain_max, 1 / 0.98, 1e-5) << verdict;
    EXPECT_NEAR(frames.report().gain_min, 1, 1e-5) << verdict << ": of none";
    EXPECT_TRUE(frames.report().held_to_patch);
  }
}

TEST_F(HeldToAPatch, AnotherPatchIsNotHeldToAndThatIsSaid) {
  MadeShot shot;
  shot.checks = patch(1);
  makeRun(folder_.path(), {{{shot}}});
  EXPECT_NEAR(greens(0.4)[0], 1, 1e-6);
  EXPECT_THAT(why_not_, ::testing::HasSubstr("under key the patch is +25 % off"));
  EXPECT_FALSE(report_.held_to_patch);
}

TEST_F(HeldToAPatch, ThatNobodyWatchedStayAsTheyAre) {
  makeRun(folder_.path(), {{{MadeShot{}}}});
  EXPECT_NEAR(greens(0.49)[0], 1, 1e-6);
  EXPECT_EQ(why_not_, "");
  EXPECT_FALSE(report_.held_to_patch);
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
