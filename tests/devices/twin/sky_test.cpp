// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/sky.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::devices::twin {
namespace {

using namespace std::chrono_literals;

Sky dayAt(double hours) {
  return skyAt(Surroundings::kDaylight, 4,
               utcFromNs(1'714'521'600'000'000'000) + fromSeconds(hours * 3600));
}

TEST(Sky, IsBlackInADarkBoxAndSteadyInARoom) {
  EXPECT_EQ(skyAt(Surroundings::kDark, 1, UtcTime{} + 12h).dome, 0);
  EXPECT_EQ(skyAt(Surroundings::kRoom, 1, UtcTime{} + 3h).dome,
            skyAt(Surroundings::kRoom, 2, UtcTime{} + 12h).dome);
}

TEST(Sky, OfADayIsDarkAtNightAndBrightAtNoon) {
  EXPECT_EQ(dayAt(0).dome, 0);
  EXPECT_EQ(dayAt(0).sun, 0);
  EXPECT_GT(dayAt(12).dome, 0.15);
  EXPECT_LE(dayAt(12).dome + dayAt(12).sun, 1.4);
}

TEST(Sky, TheSunRisesInTheEastAndStandsInTheSouth) {
  const Point morning = dayAt(8).sun_place.position_mm, noon = dayAt(12).sun_place.position_mm,
              evening = dayAt(16).sun_place.position_mm;
  double brightest = 0;
  for (int i = 0; i < 96; ++i) brightest = std::max(brightest, dayAt(i / 4.0).sun);
  EXPECT_GT(brightest, 0.3) << "some hour is clear";
  EXPECT_LT(brightest, 0.9);
  if (dayAt(8).sun > 0) {
    EXPECT_GT(morning.x, 0);
  }
  if (dayAt(12).sun > 0) {
    EXPECT_NEAR(noon.x, 0, 1);
    EXPECT_LT(noon.y, 0);
    EXPECT_NEAR(noon.z / norm(noon), std::sin(radians(45 + 10)), 1e-6);
  }
  if (dayAt(16).sun > 0) {
    EXPECT_LT(evening.x, 0);
  }
}

TEST(Sky, CloudsPassInMinutesNotInSeconds) {
  double most = 0, least = 9, jump = 0, before = dayAt(11).sun;
  for (int s = 0; s < 7200; s += 5) {
    const double sun = dayAt(11 + s / 3600.0).sun;
    most = std::max(most, sun);
    least = std::min(least, sun);
    jump = std::max(jump, std::abs(sun - before));
    before = sun;
  }
  EXPECT_GT(most - least, 0.2);
  EXPECT_LT(jump, 0.1);
}

}  // namespace
}  // namespace patina::devices::twin
