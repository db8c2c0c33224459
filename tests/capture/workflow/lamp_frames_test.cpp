// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/lamp_frames.h"

#include <gmock/gmock.h>

#include "capture/workflow/failure.h"
#include "capture/workflow/light_gain.h"
#include "processing/image/encoding.h"
#include "tests/capture/workflow/small_run.h"

namespace patina::workflow {
namespace {

using ::testing::HasSubstr;
using testing::MadeShot;
using testing::MadeStep;
using testing::TempFolder;
using ::testing::ThrowsMessage;

float linear(int level) { return linearFromSrgb(static_cast<float>(level) / 255); }

MadeShot shotOf(const std::string& light, int level, double gain = 1) {
  MadeShot shot;
  shot.light = light;
  shot.level = level;
  if (gain != 1) shot.checks = {testing::check("g", 1 / gain, "correct", gain)};
  return shot;
}

class LampFramesOf : public ::testing::Test {
 protected:
  // Green of a texel of every frame.
  std::vector<float> levels(const std::string& light, const LampCorrection& lamps, int every = 1) {
    const db::ArchiveReader reader(folder_.path());
    const std::string run = reader.runs().back().id;
    FrameSelection selection;
    selection.light = light;
    selection.every = every;
    Correction correction, plain;
    plain.light_gain = false;
    ArchiveFrames frames(reader, run, selection, plain);
    LampFrames corrected(reader, run, frames, selection, correction, lamps);
    EXPECT_EQ(corrected.count(), frames.count());
    std::vector<float> all;
    while (auto frame = corrected.next()) all.push_back(frame->linear.at(3, 3, 1));
    report_ = corrected.report();
    return all;
  }
  TempFolder folder_ = TempFolder::inMemory();
  LampFramesReport report_;
};

TEST_F(LampFramesOf, AStepLoseTheirAmbientLightBeforeTheGain) {
  std::vector<MadeStep> steps;
  for (int k = 0; k < 4; ++k)
    steps.push_back({{shotOf("key", 150 + k, 1.1), shotOf("off", 40 + k)}});
  testing::makeRun(folder_.path(), steps);
  const std::vector<float> found = levels("key", {true, false});
  ASSERT_EQ(found.size(), 4u);
  for (int k = 0; k < 4; ++k)
    EXPECT_NEAR(found[k], (linear(150 + k) - linear(40 + k)) * 1.1f, 1e-5) << k;
  EXPECT_GT(report_.noise_factor_most, 1.01);
  EXPECT_NEAR(report_.ambient_share_most, linear(43) / linear(153), 1e-3);
  EXPECT_EQ(report_.input_sha256s.size(), 4u);
  EXPECT_EQ(levels("key", {true, false}, 2).size(), 2u) << "every second one";
}

TEST_F(LampFramesOf, LampsThatDriftedApartAreUndoneByTheirOwnShots) {
  // fill gives 10 % less than at first, key 10 % more.
  testing::makeRun(folder_.path(), {{{shotOf("fill", 90, 1 / 0.9), shotOf("key", 120, 1 / 1.1),
                                      shotOf("fill+key", 160, 0.97)}}});
  const std::vector<float> found = levels("fill+key", {false, true});
  ASSERT_EQ(found.size(), 1u);
  const float expected = linear(160) - (1 - 1 / 0.9f) * linear(90) - (1 - 1 / 1.1f) * linear(120);
  EXPECT_NEAR(found[0], expected, 1e-5) << "and not by the gain of both";
  EXPECT_NEAR(levels("key", {false, true})[0], linear(120) / 1.1f, 1e-5) << "one lamp: its gain";
}

void keepGains(const std::filesystem::path& archive, const std::string& light) {
  LightGainRequest request;
  request.run = "latest";
  request.selection.light = light;
  request.patch = {2, 2, 10, 10};
  Progress progress;
  measureLightGain(archive, request, testing::now(), progress);
}

TEST_F(LampFramesOf, ARunMeasuredSinceTakeTheMeasuredGainsBeforeThoseOfTheGate) {
  std::vector<MadeStep> steps;
  for (const int level : {140, 150, 160})
    steps.push_back({{shotOf("key", level, 1.5), shotOf("off", 40)}});
  testing::makeRun(folder_.path(), steps);
  keepGains(folder_.path(), "key");
  const std::vector<float> found = levels("key", {true, false});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[0], (linear(140) - linear(40)) * linear(150) / linear(140), 1e-4);
  EXPECT_NEAR(found[1], linear(150) - linear(40), 1e-4);
  EXPECT_TRUE(report_.gain_measured);
  EXPECT_EQ(report_.input_sha256s.size(), 4u) << "three dark frames and the gains";
}

TEST_F(LampFramesOf, LampsThatDriftedApartAreMeasuredEachOrRefused) {
  std::vector<MadeStep> steps;
  for (const int drift : {0, 10, 20})
    steps.push_back({{shotOf("fill", 90), shotOf("key", 120 + drift), shotOf("fill+key", 160)}});
  testing::makeRun(folder_.path(), steps);
  keepGains(folder_.path(), "fill+key");
  keepGains(folder_.path(), "fill");
  EXPECT_THAT(([&] {
                levels("fill+key", {false, true});
              }),
              ThrowsMessage<WorkflowError>(HasSubstr("that of key was not")));
  keepGains(folder_.path(), "key");
  const std::vector<float> found = levels("fill+key", {false, true});
  EXPECT_NEAR(found[0], linear(160) + linear(130) - linear(120), 1e-4);
  EXPECT_NEAR(found[2], linear(160) + linear(130) - linear(140), 1e-4);
}

TEST_F(LampFramesOf, StatesThatAreNotThereAreAskedFor) {
  testing::makeRun(folder_.path(), {{{shotOf("fill+key", 160)}}, {{shotOf("fill+key", 160)}}});
  EXPECT_THAT(([&] {
                levels("fill+key", {true, false});
              }),
              ThrowsMessage<WorkflowError>(HasSubstr("no shots under off")));
  EXPECT_THAT(([&] {
                levels("fill+key", {false, true});
              }),
              ThrowsMessage<WorkflowError>(HasSubstr("no shots under fill")));
}

TEST_F(LampFramesOf, AStepWithoutItsDarkFrameIsNamed) {
  testing::makeRun(folder_.path(), {{{shotOf("key", 150), shotOf("off", 40)}},
                                    {{shotOf("key", 151)}},
                                    {{shotOf("key", 152), shotOf("off", 41)}}});
  EXPECT_THAT(([&] {
                levels("key", {true, false});
              }),
              ThrowsMessage<WorkflowError>(HasSubstr("step 1 has no frame of cam0 under off")));
}

}  // namespace
}  // namespace patina::workflow
