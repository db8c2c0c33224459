// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/charts.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

using namespace std::chrono_literals;

const UtcTime kStart = parseUtc("2024-05-01");

// A lamp of the known noise, 5 s from shot to shot; `level(k)` is its light without noise.
struct Lamp {
  ControlChart chart;
  ChartOptions options;
  std::uint64_t seed = 1;
  Nanoseconds interval = 5s;
  int shot = 0;
  double noise = 0.001;

  ChartJudgement shoot(double level) {
    const double noisy =
        level * (1 + noise * gaussian(hashSeed(seed, static_cast<std::uint64_t>(shot))));
    return chartLevel(chart, noisy, 0.0003, kStart + shot++ * interval, options);
  }
  Lamp& quiet(int shots) {
    for (int i = 0; i < shots; ++i) EXPECT_EQ(shoot(0.3).signal, ChartSignal::kNone) << shot;
    return *this;
  }
};

TEST(ControlChart, TellsAStepOfOnePercentWithinThreeShotsAndItsSize) {
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Lamp lamp;
    lamp.seed = seed;
    lamp.quiet(30);
    const double to = seed % 2 ? 0.303 : 0.297;
    ChartJudgement j;
    int shots = 0;
    while (shots < 3 && j.signal != ChartSignal::kStep) j = lamp.shoot(to), ++shots;
    ASSERT_EQ(j.signal, ChartSignal::kStep) << "seed " << seed;
    EXPECT_NEAR(j.step, to / 0.3 - 1, 0.006);
    for (int i = 0; i < 40; ++i)
      EXPECT_EQ(lamp.shoot(to).signal, ChartSignal::kNone) << "told twice, seed " << seed;
  }
}

TEST(ControlChart, IsIndifferentToAFifthOfAPercent) {
  Lamp lamp;
  lamp.quiet(30);
  for (int i = 0; i < 200; ++i)
    EXPECT_EQ(lamp.shoot(i / 20 % 2 ? 0.3 : 0.3006).signal, ChartSignal::kNone) << i;
}

TEST(ControlChart, IsSilentOverFourQuietWeeksAtFiveSeconds) {
  Lamp lamp;
  lamp.quiet(483'840);
}

TEST(ControlChart, FollowsALampThatWarmsUpWithinItsTimeConstantOfFiveMinutes) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Lamp lamp;
    lamp.seed = seed;
    for (int i = 0; i < 400; ++i)
      EXPECT_EQ(lamp.shoot(0.3 * (1 - 0.03 * std::exp(-i * 5 / 300.0))).signal, ChartSignal::kNone)
          << "seed " << seed << " shot " << i;
  }
}

TEST(ControlChart, IsNotDeafenedByALampThatIsColdAtItsFirstShot) {
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Lamp lamp;
    lamp.seed = seed;
    lamp.interval = 10min;
    for (int i = 0; i < 20; ++i)
      EXPECT_EQ(lamp.shoot(0.3 * (1 - 0.03 * std::exp(-i * 2.0))).signal, ChartSignal::kNone) << i;
    bool told = false;
    for (int i = 0; i < 5; ++i) told = told || lamp.shoot(0.303).signal == ChartSignal::kStep;
    EXPECT_TRUE(told) << "seed " << seed;
  }
}

TEST(ControlChart, FollowsADriftOfTwoPercentADayWithoutAWord) {
  for (const Nanoseconds interval : {Nanoseconds(5s), Nanoseconds(10min)}) {
    Lamp lamp;
    lamp.interval = interval;
    const double a_shot = 0.02 * toSeconds(interval) / 86400;
    ChartJudgement j;
    for (int i = 0; i < 4000; ++i) {
      j = lamp.shoot(0.3 * (1 - a_shot * i));
      EXPECT_EQ(j.signal, ChartSignal::kNone) << i;
    }
    EXPECT_NEAR(std::exp(lamp.chart.centre), 0.3 * (1 - a_shot * 4000), 0.0005);
  }
}

TEST(ControlChart, TellsALampThatBeginsToFlickerOnce) {
  Lamp lamp;
  lamp.quiet(60);
  lamp.noise = 0.004;
  int told = 0;
  for (int i = 0; i < 40; ++i) told += lamp.shoot(0.3).signal == ChartSignal::kFlicker ? 1 : 0;
  EXPECT_EQ(told, 1);
}

TEST(ControlChart, LearnsTheNoiseOfALampThatIsNoisierThanTheReference) {
  Lamp lamp;
  lamp.noise = 0.004;
  int signals = 0;
  for (int i = 0; i < 20'000; ++i) signals += lamp.shoot(0.3).signal != ChartSignal::kNone ? 1 : 0;
  EXPECT_EQ(signals, 0);
  EXPECT_NEAR(std::sqrt(lamp.chart.known_dispersion), 4, 0.6);
}

TEST(ControlChart, BeginsAnewAfterAGapThatNobodySaw) {
  Lamp lamp;
  lamp.quiet(40);
  lamp.shot += 1000;
  EXPECT_EQ(lamp.shoot(0.31).signal, ChartSignal::kNone);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(lamp.shoot(0.31).signal, ChartSignal::kNone);
  EXPECT_NEAR(std::exp(lamp.chart.centre), 0.31, 0.0006);
}

TEST(ControlChart, RunsAsLongAsSiegmundSays) {
  // Montgomery, 6th edition, section 9.1.4: k = 1/2, h = 5; two sides halve it to 469.
  EXPECT_NEAR(runLength(0.5, 5, 0) / 2, 469.1, 0.5);
  EXPECT_NEAR(runLength(0.5, 5, 1), 10.34, 0.05);
  EXPECT_NEAR(runLength(0.5, 5, 0.5), 6.166 * 6.166, 1e-6);
  EXPECT_GT(runLength(2, 5, 0), 1e9);  // the least k of the options
}

TEST(ControlChart, SaysWhichOptionIsOutOfItsRange) {
  ChartOptions options;
  options.cusum_limit = 0;
  EXPECT_THROW(options.check(), CalibrationError);
  options = {};
  options.level_zone = std::nan("");
  EXPECT_THROW(options.check(), CalibrationError);
  EXPECT_NO_THROW(ChartOptions{}.check());
}

TEST(Chromaticity, IsThatOfWhiteWhateverTheLevel) {
  for (const double level : {0.5, 1.0, 1.1})
    EXPECT_LT(distance(chromaticity({level, level, level}), kWhite), 2e-5);
}

TEST(Chromaticity, GivesThePrimariesTheirPlacesInTheDiagram) {
  EXPECT_NEAR(chromaticity({1, 0, 0}).u, 0.4507, 0.001);  // sRGB red: u' 0.4507, v' 0.5229
  EXPECT_NEAR(chromaticity({1, 0, 0}).v, 0.5229, 0.001);
  EXPECT_NEAR(chromaticity({0, 0, 1}).u, 0.1754, 0.001);  // blue: 0.1754, 0.1579
  EXPECT_NEAR(chromaticity({0, 0, 1}).v, 0.1579, 0.001);
  EXPECT_LT(distance(chromaticity({0, 0, 0}), kWhite), 1e-9);
}

TEST(Chromaticity, IsAsUncertainAsItsChannelsMakeIt) {
  const Chromaticity sigma = chromaticityNoise({0.01, 0.01, 0.01});
  double u = 0, v = 0;
  constexpr int kDraws = 4000;
  for (std::uint64_t i = 0; i < kDraws; ++i) {
    const auto noisy = [&](std::uint64_t c) { return 1 + 0.01 * gaussian(hashSeed(9, i, c)); };
    const Chromaticity one = chromaticity({noisy(0), noisy(1), noisy(2)});
    u += std::pow(one.u - kWhite.u, 2) / kDraws;
    v += std::pow(one.v - kWhite.v, 2) / kDraws;
  }
  EXPECT_NEAR(std::sqrt(u) / sigma.u, 1, 0.05);
  EXPECT_NEAR(std::sqrt(v) / sigma.v, 1, 0.05);
}

}  // namespace
}  // namespace patina::calibration
