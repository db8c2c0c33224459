// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/grass_blades.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace patina::devices::twin {
namespace {

constexpr Bounds kBox{-30, -30, 30, 30};

BladeField field() { return BladeField(7, GrowthJitter(8), kBox); }
std::vector<Blade> bladesOfBox() { return field().blades(); }

TEST(Logistic, RunsFromZeroToOneAndIsSteepestInTheMiddle) {
  EXPECT_EQ(logistic01(0), 0);
  EXPECT_NEAR(logistic01(0.5f), 0.5, 1e-6);
  EXPECT_NEAR(logistic01(1), 1, 1e-6);
  EXPECT_EQ(logistic01(-3), 0);
  EXPECT_GT(logistic01(0.55f) - logistic01(0.45f), 2 * (logistic01(0.1f) - logistic01(0.0f)));
}

TEST(GrassBlades, SproutAtDifferentTimesAndOnlyGrow) {
  int early = 0, late = 0;
  for (const Blade& blade : bladesOfBox()) {
    EXPECT_EQ(grown(blade, 0).rise, 0);
    early += grown(blade, 0.15f).rise > 0;
    late += grown(blade, 0.15f).rise <= 0;
    float before = 0;
    for (float time = 0.02f; time <= 1; time += 0.02f) {
      const float now = grown(blade, time).grown;
      ASSERT_GE(now, before) << time;
      before = now;
    }
    EXPECT_GT(before, 0.6f);
  }
  EXPECT_GT(early, 50);
  EXPECT_GT(late, 50);
}

TEST(GrassBlades, TheSumOfTheirStepsIsTheirLength) {
  for (const Blade& blade : bladesOfBox()) {
    const BladeNow b = grown(blade, 0.9f);
    double length = 0;
    for (int i = 0; i < 200; ++i) {
      const double slope = b.lean + b.bend * (i + 0.5) / 200;
      length += b.rise / 200 * std::sqrt(1 + slope * slope);
    }
    ASSERT_NEAR(length, blade.length * b.grown, 0.03 * blade.length);
  }
}

TEST(GrassBlades, WidenAndSwayApartAsTheyLengthen) {
  double young_tilt = 0, old_tilt = 0;
  for (const Blade& blade : bladesOfBox()) {
    const BladeNow young = grown(blade, 0.5f), old = grown(blade, 1);
    EXPECT_GE(old.half_width, young.half_width);
    young_tilt += std::abs(young.lean + young.bend / 2);
    old_tilt += std::abs(old.lean + old.bend / 2);
  }
  EXPECT_GT(old_tilt, 1.7 * young_tilt);
}

TEST(GrassBlades, TurnFromPaleYellowToDeepGreenTheTipFirst) {
  for (const Blade& blade : bladesOfBox()) {
    const BladeNow sprout = grown(blade, blade.onset + 0.16f), old = grown(blade, 1);
    if (sprout.grown <= 0 || sprout.grown > 0.2f || old.grown < 0.8f) continue;
    EXPECT_GT(sprout.tip.r, 0.8f * sprout.tip.g) << "yellow";
    EXPECT_LT(old.tip.r, 0.5f * old.tip.g) << "green";
    EXPECT_LT(old.tip.g, 0.6f * sprout.tip.g) << "deep";
    EXPECT_LT(old.tip.r / old.tip.g, old.root.r / old.root.g) << "roots stay young";
  }
}

TEST(GrassBlades, FartherOnesComeFirst) {
  const BladeField blades = field();
  EXPECT_TRUE(std::is_sorted(blades.blades().begin(), blades.blades().end(),
                             [](const Blade& a, const Blade& b) { return a.y > b.y; }));
}

// Whatever is asked for, no blade that crosses the box at any time may be missing.
TEST(GrassBlades, NearABoxAreAllThatEverCrossIt) {
  const BladeField blades = field();
  const Bounds box{-4, 2, 3, 6};
  const std::vector<std::uint32_t> near = blades.near(box);
  EXPECT_LT(near.size(), blades.blades().size() / 2) << "and not simply all";
  int crossing = 0;
  for (std::uint32_t i = 0; i < blades.blades().size(); ++i)
    for (float time = 0.02f; time <= 1; time += 0.02f) {
      const BladeNow b = grown(blades.blades()[i], time);
      bool inside = false;
      for (float q = 0; q <= 1; q += 0.02f) {
        const float h = q * b.rise, x = b.x + h * (b.lean + 0.5f * b.bend * q), y = b.y + h;
        inside |= b.rise > 0 && x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1;
      }
      if (!inside) continue;
      ++crossing;
      ASSERT_TRUE(std::binary_search(near.begin(), near.end(), i)) << i << " at " << time;
    }
  EXPECT_GT(crossing, 100);
}

TEST(GrassBlades, AreTheSameOnesForALargerRectangle) {
  const BladeField small = field(), large(7, GrowthJitter(8), {-60, -50, 80, 40});
  for (const Blade& blade : small.blades()) {
    const bool there =
        std::any_of(large.blades().begin(), large.blades().end(), [&](const Blade& other) {
          return other.x == blade.x && other.y == blade.y && other.length == blade.length;
        });
    ASSERT_TRUE(there);
  }
}

}  // namespace
}  // namespace patina::devices::twin
