// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/render/axis.h"

#include <gmock/gmock.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::render {
namespace {

using ::testing::ElementsAre;

std::vector<std::string> labelsOf(const std::vector<Tick>& ticks) {
  std::vector<std::string> out;
  for (const Tick& t : ticks)
    if (!t.label.empty()) out.push_back(t.label);
  return out;
}

TEST(Ticks, StandAtRoundNumbersWithTheDecimalsTheyNeed) {
  EXPECT_THAT(labelsOf(ticksOf(0.83, 1.07, 5, AxisKind::kNumber)),
              ElementsAre("0.85", "0.90", "0.95", "1.00", "1.05"));
  EXPECT_THAT(labelsOf(ticksOf(-100, 100, 4, AxisKind::kNumber)),
              ElementsAre("-100", "-50", "0", "50", "100"));
}

TEST(Ticks, OfAWeekAreDays) {
  EXPECT_THAT(labelsOf(ticksOf(0, 6.5 * 86400, 8, AxisKind::kElapsed)),
              ElementsAre("day 1", "day 2", "day 3", "day 4", "day 5", "day 6", "day 7"));
  EXPECT_THAT(labelsOf(ticksOf(0, 3 * 3600, 4, AxisKind::kElapsed)),
              ElementsAre("0 h", "1 h", "2 h", "3 h"));
  EXPECT_THAT(labelsOf(ticksOf(0, 60, 6, AxisKind::kElapsed)),
              ElementsAre("0 s", "10 s", "20 s", "30 s", "40 s", "50 s", "60 s"));
}

TEST(Ticks, StayInsideTheAxisAndFewForAnyRange) {
  for (std::uint64_t i = 0; i < 500; ++i) {
    const double low = gaussian(hashSeed(1, i)) * std::pow(10, 20 * uniform(hashSeed(2, i)) - 8);
    const double high = low + std::pow(10, 20 * uniform(hashSeed(3, i)) - 8) * (1 + std::abs(low));
    for (const AxisKind kind : {AxisKind::kNumber, AxisKind::kElapsed}) {
      const auto ticks = ticksOf(low, high, 6, kind);
      EXPECT_LE(labelsOf(ticks).size(), 20u) << low << " " << high;
      for (const Tick& t : ticks) {
        EXPECT_GE(t.value, low - (high - low) * 1e-5);
        EXPECT_LE(t.value, high + (high - low) * 1e-5);
      }
    }
  }
}

TEST(Ticks, OfAnEmptyOrInfiniteRangeAreNone) {
  EXPECT_TRUE(ticksOf(1, 1, 5, AxisKind::kNumber).empty());
  EXPECT_TRUE(ticksOf(2, 1, 5, AxisKind::kNumber).empty());
  EXPECT_TRUE(ticksOf(0, INFINITY, 5, AxisKind::kNumber).empty());
  EXPECT_TRUE(ticksOf(NAN, 1, 5, AxisKind::kElapsed).empty());
}

TEST(ElapsedLabel, IsAsCoarseAsTheSpanAllows) {
  EXPECT_EQ(elapsedLabel(86400 + 6 * 3600, 7 * 86400), "day 2, 06:00");
  EXPECT_EQ(elapsedLabel(0, 7 * 86400), "day 1, 00:00");
  EXPECT_EQ(elapsedLabel(86399.9, 7 * 86400), "day 2, 00:00");
  EXPECT_EQ(elapsedLabel(36 * 3600, 47 * 3600), "+36 h");
  EXPECT_EQ(elapsedLabel(5400, 47 * 3600), "+1.5 h");
  EXPECT_EQ(elapsedLabel(90, 3600), "+1.5 min");
  EXPECT_EQ(elapsedLabel(3, 60), "+3 s");
}

}  // namespace
}  // namespace patina::render
