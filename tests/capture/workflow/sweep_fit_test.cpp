// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/workflow/sweep_fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "capture/workflow/failure.h"
#include "tests/support/temp_folder.h"

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

TEST(PixelsUnder, AreTheRegionOverTheWhiteLevel) {
  StateLight state;
  state.white_level = 0.5;
  const Image<float> pixels = pixelsUnder(state, ramp(9, 7).view(), {1, 2, 6, 4}, 1);
  ASSERT_EQ(pixels.size(), (SizePx{6, 4}));
  EXPECT_FLOAT_EQ(pixels.at(5, 3, 2), 2 * 256.0f);
}

// A frame that a card has made even is 1 everywhere; what a lamp 100 mm above the middle would show
// falls off with the distance and the angle.
TEST(PixelsUnder, PutTheFallOffOfAnEvenFramesLampBack) {
  StateLight state;
  state.even = true;
  state.white_level = 0.25;
  state.light.near = true;
  state.light.position_mm = {0, 0, 100};
  state.light.strength = 1e4f;
  const Image<float> card(50, 50, 3, 1);
  const Image<float> pixels = pixelsUnder(state, card.view(), {0, 0, 5, 5}, 50);
  EXPECT_NEAR(pixels.at(2, 2, 0), 1, 1e-5);
  EXPECT_NEAR(pixels.at(4, 2, 0), std::pow(0.5, 1.5), 1e-5);  // 100 mm off: cos^3 of 45 degrees
}

TEST(NoiseOfPixels, IsThatOfGreenScaledAsPicturesAre) {
  calibration::NoiseModel green;
  green.electrons_per_number = 2;
  green.read_noise_e = 20;
  green.white_level = 1000;
  std::vector<StateLight> states(2);
  states[0].white_level = 0.5;
  const brdf::FitNoise noise = noiseOfPixels(green, states);
  const double scale = 1.5;
  EXPECT_NEAR(noise.floor, scale * std::sqrt(green.variance(0)) / 1000, 1e-7);
  EXPECT_NEAR(noise.shot, scale / (2 * 1000), 1e-9);
}

TEST(NoiseOfPixels, OfAveragedShotsFallsByTheirRootButForWhatCalibrationsAreOffBy) {
  const std::vector<StateLight> states(1);
  const brdf::FitNoise one = noiseOfPixels({}, states), sixteen = noiseOfPixels({}, states, 16);
  EXPECT_NEAR(sixteen.floor, one.floor / 4, 1e-6f * one.floor);
  EXPECT_NEAR(sixteen.shot, one.shot / 16, 1e-6f * one.shot);
  EXPECT_LT(sixteen.gain, 0.6f * one.gain);
  EXPECT_GT(sixteen.gain, one.gain / 4);
}

TEST(NoiseOfPixels, IsLessWhereAllLampsAreHeldByThePatch) {
  std::vector<StateLight> states(2);
  const float flickering = noiseOfPixels({}, states).gain;
  states[0].by_patch = true;
  EXPECT_EQ(noiseOfPixels({}, states).gain, flickering) << "one of two";
  states[1].by_patch = true;
  EXPECT_LT(noiseOfPixels({}, states).gain, 0.6f * flickering);
}

TEST(FiltersAt, AreThoseThatARegionBeginsWith) {
  constexpr brdf::Filters kRggb{0, 1, 1, 2};
  EXPECT_EQ(filtersAt(kRggb, 4, 2), kRggb);
  EXPECT_EQ(filtersAt(kRggb, 1, 0), (brdf::Filters{1, 0, 2, 1}));
  EXPECT_EQ(filtersAt(kRggb, 2, 3), (brdf::Filters{1, 2, 0, 1}));
  EXPECT_EQ(filtersAt(kRggb, 1, 1), (brdf::Filters{2, 1, 1, 0}));
}

// Pixels of one sweep: red 0.4, green 0.3, blue 0.2, matt, up; a crack one pixel wide, of the same
// colour, that only lamps near the zenith reach.
class CrackedSweep {
 public:
  CrackedSweep() {
    for (int i = 0; i < 16; ++i) {
      const double z = 1 - 0.6 * (i + 0.5) / 16, turn = 2.4 * i, across = std::sqrt(1 - z * z);
      StateLight state;
      state.light.direction = {static_cast<float>(across * std::cos(turn)),
                               static_cast<float>(across * std::sin(turn)), static_cast<float>(z)};
      fit.states.push_back(state);
      Image<float> picture(24, 24, 3);
      for (int y = 0; y < 24; ++y)
        for (int x = 0; x < 24; ++x)
          for (int c = 0; c < 3; ++c) {
            const bool own = c == (x & 1) + (y & 1);  // else mixed from neighbours: no one's
            const double level = (0.4 - 0.1 * c) * z * (x == 9 && z < 0.75 ? 0 : 1);
            picture.at(x, y, c) = static_cast<float>(own ? level : 0.77);
          }
      sweep.pictures.push_back({static_cast<std::size_t>(i), std::move(picture)});
    }
    fit.region = {0, 0, 24, 24};
    fit.bin = 4;
    fit.options.deep_shadows = true;
    fit.options.filters = brdf::Filters{0, 1, 1, 2};
  }
  SweepFit fit;
  SweepPictures sweep;
};

TEST(FitSweep, TellsACracksColourFromItsShadowByTheMosaicsOwnSamples) {
  const CrackedSweep cracked;
  Progress progress;
  const brdf::MultiLightFit fit = fitSweep(cracked.fit, cracked.sweep, 0, progress);
  ASSERT_EQ(fit.maps.diffuse.size(), (SizePx{6, 6}));
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(fit.maps.diffuse.at(x, y, c), 0.4 - 0.1 * c, 0.012)
            << x << ' ' << y << ' ' << c;
}

TEST(FitSweep, KeepsPixelsOfTheStepBeforeForTheNext) {
  CrackedSweep cracked;
  const patina::testing::TempFolder folder;
  cracked.fit.pixels = folder / "pixels";
  Progress progress;
  for (int step = 0; step < 3; ++step) fitSweep(cracked.fit, cracked.sweep, step, progress);
  EXPECT_FALSE(brdf::brdfStepIsThere(cracked.fit.pixels, 0));
  EXPECT_TRUE(brdf::brdfStepIsThere(cracked.fit.pixels, 1));
  EXPECT_TRUE(brdf::brdfStepIsThere(cracked.fit.pixels, 2));
}

}  // namespace
}  // namespace patina::workflow
