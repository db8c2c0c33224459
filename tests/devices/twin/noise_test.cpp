// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::devices::twin {
namespace {

TEST(GradientNoise, IsZeroOnTheLatticeAndBoundedBetween) {
  for (int i = -5; i < 5; ++i)
    EXPECT_EQ(gradientNoise(1, static_cast<float>(i), static_cast<float>(3 * i)), 0.0f);
  for (int i = 0; i < 10'000; ++i)
    ASSERT_LE(std::abs(gradientNoise(2, 0.137f * i, -0.391f * i)), 1.0f);
}

TEST(GradientNoise, HasNoMeanAndTheSpreadItsHeaderStates) {
  double sum = 0, sum2 = 0;
  const int n = 200'000;
  for (int i = 0; i < n; ++i) {
    const double v = gradientNoise(3, 0.3712f * (i % 500), 0.4178f * (i / 500));
    sum += v;
    sum2 += v * v;
  }
  EXPECT_NEAR(sum / n, 0, 0.01);
  EXPECT_NEAR(std::sqrt(sum2 / n), 0.33, 0.05);
}

TEST(GradientNoise, IsContinuousAcrossCells) {
  for (int i = 1; i < 100; ++i) {
    const float x = static_cast<float>(i), y = 0.37f * i;
    EXPECT_NEAR(gradientNoise(4, x - 1e-4f, y), gradientNoise(4, x + 1e-4f, y), 2e-3);
  }
}

TEST(GradientNoise, DoesNotRepeatAfterAnyOfTheUsualPeriods) {
  for (const float period : {16.0f, 64.0f, 256.0f, 1024.0f}) {
    double difference = 0;
    for (int i = 0; i < 100; ++i)
      difference += std::abs(gradientNoise(5, 0.5f + i * 0.25f, 0.4f) -
                             gradientNoise(5, 0.5f + i * 0.25f + period, 0.4f));
    EXPECT_GT(difference / 100, 0.1) << period;
  }
}

TEST(FractalNoise, ForgetsWhatATexelAveragesAway) {
  const FractalNoise noise{7, 1.0f, 4, 0.5f, 1, 1};
  double fine = 0, coarse = 0;
  for (int i = 0; i < 1000; ++i) {
    fine += std::abs(noise.at(0.317f * i, 0.11f * i, 0.01f));
    coarse += std::abs(noise.at(0.317f * i, 0.11f * i, 1.0f));
  }
  EXPECT_GT(fine / 1000, 0.1);
  EXPECT_EQ(coarse, 0);
}

TEST(FractalNoise, StretchesAlongItsAxis) {
  const FractalNoise fibre{8, 1.0f, 1, 0.5f, 1, 16};
  double along = 0, across = 0;
  for (int i = 0; i < 1000; ++i) {
    const float x = 0.731f * i, y = 1.37f * i;
    along += std::abs(fibre.at(x, y + 0.2f, 0.01f) - fibre.at(x, y, 0.01f));
    across += std::abs(fibre.at(x + 0.2f, y, 0.01f) - fibre.at(x, y, 0.01f));
  }
  EXPECT_GT(across, 8 * along);
}

TEST(FractalNoise, RidgesStayWithinZeroAndOne) {
  const FractalNoise noise{9, 2.0f, 5, 0.6f, 1, 1};
  for (int i = 0; i < 10'000; ++i) {
    const float v = noise.ridged(0.173f * i, 0.219f * i, 0.05f);
    ASSERT_GE(v, 0.0f);
    ASSERT_LE(v, 1.0f);
  }
}

}  // namespace
}  // namespace patina::devices::twin
