// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_texels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "capture/workflow/failure.h"

namespace patina::workflow {
namespace {

Image<float> ramp(int width, int height) {
  Image<float> frame(width, height, 3);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int c = 0; c < 3; ++c) frame.at(x, y, c) = static_cast<float>(x + 10 * y + 100 * c);
  return frame;
}

TEST(WholeTexels, LeaveOutWhatIsOverAtTheRightAndBelow) {
  const RectPx r = wholeTexels({3, 1, 11, 9}, 4);
  EXPECT_EQ(r.x, 3);
  EXPECT_EQ(r.y, 1);
  EXPECT_EQ(r.width, 8);
  EXPECT_EQ(r.height, 8);
  EXPECT_THROW(wholeTexels({0, 0, 11, 3}, 4), WorkflowError);
  EXPECT_THROW(wholeTexels({0, 0, 11, 9}, 0), WorkflowError);
}

TEST(TexelsUnder, AreMeansOfTheirPixelsOverTheWhiteLevel) {
  StateLight state;
  state.white_level = 0.5;
  const Image<float> frame = ramp(9, 7);
  const Image<float> texels = texelsUnder(state, frame.view(), {1, 2, 6, 4}, 2, 1);
  ASSERT_EQ(texels.size(), (SizePx{3, 2}));
  // Pixels 3 and 4 of rows 4 and 5: 3.5 + 45 + 100.
  EXPECT_FLOAT_EQ(texels.at(1, 1, 1), 2 * 148.5f);
  EXPECT_FLOAT_EQ(texelsUnder(state, frame.view(), {1, 2, 6, 4}, 1, 1).at(5, 3, 2), 2 * 256.0f);
}

TEST(TexelsUnder, AreNotKnownWhereAPixelIsNot) {
  Image<float> frame = ramp(4, 4);
  frame.at(1, 2, 0) = std::numeric_limits<float>::quiet_NaN();
  const Image<float> texels = texelsUnder({}, frame.view(), {0, 0, 4, 4}, 2, 1);
  EXPECT_TRUE(std::isnan(texels.at(0, 1, 0)));
  EXPECT_FALSE(std::isnan(texels.at(0, 1, 1)));
  EXPECT_FALSE(std::isnan(texels.at(1, 1, 0)));
}

// A frame that a card has made even is 1 everywhere; what a lamp 100 mm above the middle would show
// falls off with the distance and the angle.
TEST(TexelsUnder, PutTheFallOffOfAnEvenFramesLampBack) {
  StateLight state;
  state.even = true;
  state.white_level = 0.25;
  state.light.near = true;
  state.light.position_mm = {0, 0, 100};
  state.light.strength = 1e4f;
  const Image<float> card(50, 50, 3, 1);
  const Image<float> texels = texelsUnder(state, card.view(), {0, 0, 50, 50}, 10, 50);
  EXPECT_NEAR(texels.at(2, 2, 0), 1, 1e-5);
  EXPECT_NEAR(texels.at(4, 2, 0), std::pow(0.5, 1.5), 1e-5);  // 100 mm off: cos^3 of 45 degrees
}

TEST(NoiseOfTexels, FallsWithTheSamplesOfOneColourInATexel) {
  calibration::NoiseModel green;
  green.electrons_per_number = 2;
  green.read_noise_e = 20;
  green.white_level = 1000;
  std::vector<StateLight> states(2);
  states[0].white_level = 0.5;
  const brdf::FitNoise one = noiseOfTexels(green, states, 1),
                       four = noiseOfTexels(green, states, 4);
  const double scale = 1.5;
  EXPECT_NEAR(one.floor, scale * std::sqrt(green.variance(0)) / 1000, 1e-7);
  EXPECT_NEAR(one.shot, scale / (2 * 1000), 1e-9);
  EXPECT_NEAR(four.floor, one.floor / 2, 1e-7);
  EXPECT_NEAR(four.shot, one.shot / 4, 1e-9);
}

}  // namespace
}  // namespace patina::workflow
