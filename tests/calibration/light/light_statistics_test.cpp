// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/light_statistics.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;

const UtcTime kStart = parseUtc("2024-05-01");

Image<float> flat(int width, int height, float level, double noise, std::uint64_t seed) {
  Image<float> image(width, height, 3);
  std::uint64_t i = 0;
  for (float& v : image.texels())
    v = level * static_cast<float>(1 + noise * gaussian(hashSeed(seed, i++)));
  return image;
}

TEST(MeasurePatch, FindsTheLevelOfANoisyPatchDespiteDustAndGlints) {
  Image<float> image = flat(40, 40, 0.4f, 0.02, 7);
  for (int i = 0; i < 40; ++i) image.at(i, 3, 1) = i % 2 ? 0.0f : 1.0f;  // 2.5 % of the texels
  const PatchLevel p = measurePatch(image.view(), {0, 0, 40, 40});
  ASSERT_EQ(p.channels, 3);
  for (std::size_t c = 0; c < 3; ++c) {
    EXPECT_NEAR(p.level[c], 0.4, 0.0006);
    EXPECT_NEAR(p.noise[c], 0.02 / 40, 0.02 / 40 * 0.3);
  }
}

TEST(MeasurePatch, DoesNotTakeAGradientOfTheLightForNoise) {
  Image<float> image = flat(64, 64, 0.4f, 0.01, 7);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c) image.at(x, y, c) *= 1 + 0.2f * static_cast<float>(x) / 64;
  const PatchLevel p = measurePatch(image.view(), {0, 0, 64, 64});
  EXPECT_LT(p.noise[0], 0.01 / 64 * 1.5);
  EXPECT_GT(p.spread[0], 0.02);
}

TEST(MeasurePatch, FindsBandsOfARollingShutterAndNoneInNoise) {
  Image<float> image = flat(64, 64, 0.4f, 0.01, 7);
  EXPECT_EQ(measurePatch(image.view(), {0, 0, 64, 64}).banding, 0);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) *= 1 + 0.01f * static_cast<float>(std::sin(2 * M_PI * y / 16.0));
  const PatchLevel p = measurePatch(image.view(), {0, 0, 64, 64});
  EXPECT_NEAR(p.banding, 0.01, 0.001);
  EXPECT_NEAR(p.banding_rows, 16, 1e-9);
}

TEST(MeasurePatch, FindsBandsInAMosaicAndTakesNoGradientForOne) {
  Image<std::uint16_t> mosaic(64, 64, 1);
  const auto fill = [&](double banding, double gradient) {
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x) {
        const double noise = 1 + 0.01 * gaussian(hashSeed(3, 64 * static_cast<std::uint64_t>(y) +
                                                                 static_cast<std::uint64_t>(x)));
        const double level = 1 + banding * std::sin(2 * M_PI * y / 16.0) + gradient * y / 64;
        mosaic.at(x, y) = static_cast<std::uint16_t>(64 + 1000 * noise * level);
      }
    return measurePatch(mosaic.view(), {0, 1, 1, 2}, 64, 4064, {0, 0, 64, 64});
  };
  EXPECT_EQ(fill(0, 0.2).banding, 0);
  const PatchLevel p = fill(0.02, 0.2);
  EXPECT_NEAR(p.banding, 0.02, 0.004);
  EXPECT_NEAR(p.banding_rows, 16, 1e-9);
}

TEST(MeasurePatch, ReadsTheMosaicAsTheColoursItHolds) {
  Image<std::uint16_t> mosaic(16, 16, 1);
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 16; ++x)
      mosaic.at(x, y) = static_cast<std::uint16_t>(
          64 + ((y & 1) ? ((x & 1) ? 300 : 200) : ((x & 1) ? 200 : 100)));
  const std::array<std::uint8_t, 4> rggb{0, 1, 1, 2};
  const PatchLevel p = measurePatch(mosaic.view(), rggb, 64, 1064, {3, 5, 9, 7});
  EXPECT_NEAR(p.level[0], 0.1, 1e-6);
  EXPECT_NEAR(p.level[1], 0.2, 1e-6);
  EXPECT_NEAR(p.level[2], 0.3, 1e-6);
  EXPECT_EQ(p.saturated_fraction, 0);
}

TEST(MeasurePatch, CountsSaturatedSamples) {
  Image<float> image = flat(20, 20, 0.5f, 0, 1);
  for (int x = 0; x < 20; ++x) image.at(x, 0, 0) = 1;
  EXPECT_NEAR(measurePatch(image.view(), {0, 0, 20, 20}).saturated_fraction, 20.0 / 1200, 1e-9);
}

TEST(MeasurePatch, RefusesAPatchOutsideThePicture) {
  const Image<float> image = flat(20, 20, 0.5f, 0, 1);
  EXPECT_THROW(measurePatch(image.view(), {10, 10, 11, 5}), CalibrationError);
  EXPECT_THROW(measurePatch(image.view(), {-1, 0, 5, 5}), CalibrationError);
  EXPECT_THROW(measurePatch(image.view(), {0, 0, 1, 1}), CalibrationError);
}

// A series that has learned `level`.
LightSeries learned(double level, const LightModelOptions& options = {}) {
  LightSeries s;
  for (int i = 0; i < options.learn_samples; ++i)
    EXPECT_EQ(judgeLevel(s, level, kStart + i * 1min, options).verdict, LightVerdict::kLearn);
  return s;
}

TEST(JudgeLevel, LearnsOnlyFromSteadySamples) {
  const LightModelOptions options;
  LightSeries s;
  // Ten minutes apart, a lamp that stays on warms by 3 % with a time constant of five.
  double baseline = 0;
  for (int i = 0; i < 6; ++i) {
    const double level = 0.4 * (1 - 0.03 * std::exp(-2.0 * i));
    const auto j = judgeLevel(s, level, kStart + i * 10min, options);
    EXPECT_NE(j.verdict, LightVerdict::kHold) << i;
    if (s.baseline > 0) baseline = s.baseline;
  }
  EXPECT_NEAR(baseline / 0.4, 1, 0.002);
}

TEST(JudgeLevel, FollowsAWarmUpThatItSeesOftenEnough) {
  const LightModelOptions options;
  LightSeries s;
  for (int i = 0; i < 1000; ++i) {
    const double level = 0.4 * (1 - 0.03 * std::exp(-i * 5.0 / 300));
    const auto j = judgeLevel(s, level * (1 + 0.001 * gaussian(hashSeed(3, i))), kStart + i * 5s,
                              options, 0.002);
    ASSERT_NE(j.verdict, LightVerdict::kHold) << i;
    if (s.baseline > 0) {
      ASSERT_NEAR(j.gain * level / s.baseline, 1, 0.006) << i;
    }
  }
}

TEST(JudgeLevel, HoldsAStepOfEitherSignAtItsFirstShotAndForgetsIt) {
  for (const double step : {1.05, 0.95, 0.0}) {
    LightSeries s = learned(0.4);
    const double before = s.forecast;
    EXPECT_EQ(judgeLevel(s, 0.4 * step, kStart + 10min, {}).verdict, LightVerdict::kHold);
    EXPECT_EQ(s.forecast, before);
    EXPECT_EQ(judgeLevel(s, 0.4, kStart + 20min, {}).verdict, LightVerdict::kPass);
  }
}

TEST(JudgeLevel, CorrectsADriftOfOnePercentADay) {
  for (const auto interval : {Nanoseconds(5s), Nanoseconds(10min)}) {
    LightSeries s;
    double worst = 0, sum = 0;
    int n = 0;
    for (int i = 0; i * interval < Nanoseconds(72h); ++i) {
      const double days = toSeconds(i * interval) / 86400;
      const double lamp = (1 + 0.01 * days) * (1 + 0.001 * gaussian(hashSeed(11, i)));
      const double seen = 0.4 * lamp * (1 + 0.0015 * gaussian(hashSeed(12, i)));
      const auto j = judgeLevel(s, seen, kStart + i * interval, {}, 0.0015);
      ASSERT_NE(j.verdict, LightVerdict::kHold);
      if (days < 0.5) continue;
      EXPECT_TRUE(j.verdict == LightVerdict::kCorrect || j.verdict == LightVerdict::kPass);
      const double error = std::abs(j.gain * lamp - 0.4 / 0.4);
      worst = std::max(worst, error);
      sum += error;
      ++n;
    }
    EXPECT_LT(sum / n, 0.0015);
    EXPECT_LT(worst, 0.006);
  }
}

TEST(JudgeLevel, FailsWhenTheDriftLeavesTheTotalBand) {
  LightSeries s = learned(0.4);
  LightVerdict last{};
  for (int i = 0; i < 400 && last != LightVerdict::kFail; ++i)
    last = judgeLevel(s, 0.4 * (1 - 0.0005 * i), kStart + i * 10min, {}).verdict;
  EXPECT_EQ(last, LightVerdict::kFail);
  EXPECT_NEAR(s.forecast / 0.4, 0.85, 0.002);
}

TEST(JudgeLevel, NamesAStepAmongTheSamplesItLearnsFromButNotALampThatWarms) {
  const std::vector<double> warming = {0.388, 0.3984, 0.3998}, up = {0.4, 0.4, 0.42},
                            back = {0.388, 0.399, 0.38}, late = {0.39, 0.392, 0.412};
  const auto told = [](const std::vector<double>& levels) {
    LightSeries s;
    double step = 0;
    for (std::size_t i = 0; i < levels.size(); ++i)
      step = judgeLevel(s, levels[i], kStart + static_cast<int>(i) * 10min, {}).step_while_learning;
    return step;
  };
  EXPECT_EQ(told(warming), 0);
  EXPECT_NEAR(told(up), 0.05, 1e-9);
  EXPECT_LT(told(back), -0.04);
  EXPECT_GT(told(late), 0.05);
}

TEST(JudgeLevel, TrustsABaselineOnceTenLevelsHaveAgreed) {
  LightSeries s = learned(0.4);
  for (int agreed = 3; agreed < 10; ++agreed) {
    EXPECT_TRUE(isProvisional(s, {})) << agreed;
    EXPECT_EQ(judgeLevel(s, 0.42, kStart + 10min, {}).verdict, LightVerdict::kHold);
    judgeLevel(s, 0.4, kStart + 10min, {});
  }
  EXPECT_FALSE(isProvisional(s, {}));
  EXPECT_FALSE(isProvisional(LightSeries{}, {}));
}

TEST(JudgeLevel, CountsTheSteadySamplesAtTheEnd) {
  LightSeries s;
  EXPECT_EQ(steadySamples(s, {}), 0);
  judgeLevel(s, 0.4, kStart, {});
  judgeLevel(s, 0.401, kStart, {});
  EXPECT_EQ(steadySamples(s, {}), 2);
  judgeLevel(s, 0.42, kStart, {});
  EXPECT_EQ(steadySamples(s, {}), 1);
}

TEST(SettledLevel, IsTheMeanOfTheNewerHalfHoweverNoisyItsLevels) {
  const std::vector<double> noisy = {0.404, 0.396, 0.402, 0.398, 0.403, 0.397};
  EXPECT_NEAR(settledLevel(noisy, {}).value(), (0.398 + 0.403 + 0.397) / 3, 1e-12);
}

TEST(SettledLevel, IsNoneWhileTheLightStillChangesOrFlickersOrIsNotThere) {
  EXPECT_FALSE(settledLevel({}, {}));
  EXPECT_FALSE(settledLevel({0.4}, {}));
  EXPECT_FALSE(settledLevel({0.400, 0.401, 0.402, 0.407, 0.408, 0.409}, {}));
  EXPECT_FALSE(settledLevel({0.39, 0.41, 0.40, 0.41, 0.39, 0.40}, {}));
  EXPECT_FALSE(settledLevel({0.001, 0.001, 0.001, 0.001}, {}));
}

TEST(JudgeLevel, LearnsNothingFromDarkness) {
  LightSeries s;
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(judgeLevel(s, 0.0001, kStart + i * 1min, {}).verdict, LightVerdict::kHold);
  EXPECT_EQ(s.baseline, 0);
  EXPECT_EQ(judgeLevel(s, std::nan(""), kStart, {}).verdict, LightVerdict::kHold);
}

TEST(JudgeLevel, TakesInAnExchangedLampAfterDays) {
  LightSeries s = learned(0.4);
  EXPECT_EQ(judgeLevel(s, 0.38, kStart + 24h, {}).verdict, LightVerdict::kHold);
  EXPECT_EQ(judgeLevel(s, 0.38, kStart + 48h, {}).verdict, LightVerdict::kCorrect);
}

TEST(JudgeLevel, IsNotLoosenedByAClockThatGoesBack) {
  LightSeries s = learned(0.4);
  EXPECT_EQ(judgeLevel(s, 0.42, kStart - 24h * 365, {}).verdict, LightVerdict::kHold);
  EXPECT_EQ(judgeLevel(s, 0.4, kStart - 24h * 365, {}).verdict, LightVerdict::kPass);
}

TEST(LightModelOptions, NameTheFieldAndItsRange) {
  LightModelOptions options;
  options.learn_samples = 0;
  EXPECT_THROW(options.check(), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
