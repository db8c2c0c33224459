// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/light/warm_up.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "calibration/failure.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

struct Curve {
  std::vector<double> time_s, level;
};
Curve curve(double missing, double tau_s, double every_s, int shots, double noise = 0.001) {
  Curve c;
  for (int i = 0; i < shots; ++i) {
    c.time_s.push_back(i * every_s);
    c.level.push_back(0.4 * (1 - missing * std::exp(-i * every_s / tau_s)) *
                      (1 + noise * gaussian(hashSeed(3, static_cast<std::uint64_t>(i)))));
  }
  return c;
}

TEST(WarmUp, FindsTheTimeConstantOfALampAndHowLongToWait) {
  const Curve c = curve(0.03, 300, 5, 360);
  const WarmUp fit = fitWarmUp(c.time_s, c.level);
  ASSERT_TRUE(fit.found);
  EXPECT_NEAR(toSeconds(fit.tau), 300, 15);
  EXPECT_NEAR(fit.missing, 0.03, 0.0005);
  EXPECT_NEAR(fit.warm, 0.4, 0.0002);
  EXPECT_NEAR(fit.residual, 0.001, 0.0002);
  EXPECT_NEAR(toSeconds(fit.waitFor(0.001)), 300 * std::log(30), 60);
}

TEST(WarmUp, FindsALampThatSagsAsItWarms) {
  const Curve c = curve(-0.05, 120, 5, 200);
  const WarmUp fit = fitWarmUp(c.time_s, c.level);
  ASSERT_TRUE(fit.found);
  EXPECT_NEAR(fit.missing, -0.05, 0.002);
  EXPECT_NEAR(toSeconds(fit.tau), 120, 8);
}

TEST(WarmUp, FindsNoneInALampThatIsWarm) {
  const Curve c = curve(0, 300, 5, 200);
  EXPECT_FALSE(fitWarmUp(c.time_s, c.level).found);
  EXPECT_EQ(fitWarmUp(c.time_s, c.level).waitFor(0.001).count(), 0);
}

TEST(WarmUp, AsksForEnoughLevelsAndAsManyAsTimes) {
  const Curve c = curve(0.03, 300, 5, 5);
  EXPECT_FALSE(fitWarmUp(c.time_s, c.level).found);
  EXPECT_THROW(fitWarmUp(c.time_s, std::span(c.level).first(4)), CalibrationError);
}

TEST(Regression, FindsHowTheLightFollowsTheTemperature) {
  std::vector<double> celsius, ratio;
  for (int i = 0; i < 500; ++i) {
    celsius.push_back(20 + 2 * std::sin(i * 0.05));
    ratio.push_back(1 - 0.002 * (celsius.back() - 20) +
                    0.001 * gaussian(hashSeed(5, static_cast<std::uint64_t>(i))));
  }
  const Regression r = regress(celsius, ratio);
  EXPECT_NEAR(r.slope, -0.002, 4 * r.slope_error);
  EXPECT_NEAR(r.slope_error, 0.001 / std::sqrt(2 * 500.0), 0.00001);
  EXPECT_LT(r.correlation, -0.9);
}

TEST(Regression, SaysNothingOfATemperatureThatDoesNotMove) {
  const std::vector<double> celsius(10, 20.0), ratio(10, 1.0);
  EXPECT_EQ(regress(celsius, ratio).slope, 0);
  EXPECT_EQ(regress(celsius, ratio).slope_error, 0);
}

}  // namespace
}  // namespace patina::calibration
