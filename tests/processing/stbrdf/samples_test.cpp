// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/stbrdf/samples.h"

#include <gmock/gmock.h>

#include <cmath>

namespace patina::stbrdf {
namespace {

using testing::HasSubstr;

TimeSamples even(const std::string& name, float value) {
  return {name, {0, 0.5, 1}, std::vector<Image<float>>(3, Image<float>(4, 3, 1, value))};
}

std::string refusal(const TimeSamples& samples) {
  try {
    checkSamples(samples);
  } catch (const ProcessingError& e) {
    return e.exit() == Exit::kBadData ? e.what() : "another exit code";
  }
  return "taken";
}

TEST(CheckSamples, TakesWhatLiesInItsRangeOrALittleBeside) {
  EXPECT_EQ(refusal(even("Diffuse", 0.5f)), "taken");
  EXPECT_EQ(refusal(even("Diffuse", 1.2f)), "taken");
}

TEST(CheckSamples, NamesTheMapTheStepAndTheTexel) {
  TimeSamples samples = even("Roughness", 0.5f);
  samples.maps[2].at(1, 2) = NAN;
  EXPECT_THAT(refusal(samples), HasSubstr("Roughness of step 2 holds nan at (1, 2)"));
  samples.maps[2].at(1, 2) = 40;
  EXPECT_THAT(refusal(samples), HasSubstr("40.000000 at (1, 2), far outside [0.000000, 1.0"));
  samples.maps[2] = Image<float>(3, 4, 1);
  EXPECT_THAT(refusal(samples), HasSubstr("step 2 is 3x4 with 1 channels; step 0 is 4x3"));
  samples.maps.pop_back();
  EXPECT_THAT(refusal(samples), HasSubstr("2 maps at 3 times"));
}

TEST(ChooseRange, FollowsTheNormalsAndTheHeights) {
  TimeSamples normal = even("Normal", 0.5f), height = even("Height", 0.5f),
              diffuse = even("Diffuse", -0.5f);
  chooseRange(normal);
  EXPECT_EQ(normal.low, 0);
  normal.maps[1].at(0, 0) = -0.4f;
  chooseRange(normal);
  EXPECT_EQ(normal.low, -1);
  EXPECT_EQ(normal.high, 1);
  height.maps[1].at(0, 0) = 7;
  chooseRange(height);
  EXPECT_EQ(height.low, 0.5f);
  EXPECT_EQ(height.high, 7);
  chooseRange(diffuse);
  EXPECT_EQ(diffuse.low, 0);
}

}  // namespace
}  // namespace patina::stbrdf
