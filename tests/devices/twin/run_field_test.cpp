// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/run_field.h"

#include <gtest/gtest.h>

#include <cmath>

namespace patina::devices::twin {
namespace {

RunOptions one() {
  RunOptions o;
  o.seed = 7;
  o.probability = 0.5f;
  return o;
}

TEST(RunField, RunsGoDownFromTheirSources) {
  const RunField field(one(), 0, 0, 40, 80);
  double below = 0, above = 0, sources = 0;
  for (float x = 0.05f; x < 40; x += 0.1f)
    for (float y = 45; y < 78; y += 0.1f) {
      if (field.at(x, y, 0).source_mm > 0.07f) continue;
      ++sources;
      below += field.at(x, y - 1.2f, 0).strength;
      above += field.at(x, y + 1.2f, 0).strength;
    }
  ASSERT_GT(sources, 5);
  EXPECT_GT(below / sources, 0.5);
  EXPECT_GT(below, 3 * above) << "other runs pass there";
}

TEST(RunField, TheTipPassesLowerPlacesLater) {
  const RunField field(one(), 0, 0, 40, 80);
  int followed = 0;
  for (float x = 0.5f; x < 40; x += 0.5f) {
    for (float y = 40; y < 70; y += 0.5f) {
      const auto above = field.at(x, y, 0), below = field.at(x, y - 0.5f, 0);
      if (above.strength < 0.2f || below.strength < 0.2f) continue;
      if (above.source_onset != below.source_onset) continue;
      if (std::abs(below.time - above.time) > 0.05f) continue;  // another run
      EXPECT_GT(below.time, above.time);
      ++followed;
    }
  }
  EXPECT_GT(followed, 100);
}

TEST(RunField, IsNarrowAndTall) {
  const RunField field(one(), 0, 0, 60, 60);
  double across = 0, along = 0;  // edges
  const auto stained = [&](float x, float y) { return field.at(x, y, 0).strength > 0.15f; };
  for (float x = 1; x < 59; x += 0.2f)
    for (float y = 1; y < 59; y += 0.2f) {
      across += stained(x, y) != stained(x + 0.2f, y);
      along += stained(x, y) != stained(x, y + 0.2f);
    }
  EXPECT_GT(across, 4 * along);
}

TEST(RunField, DoesNotDependOnTheRectangleItCovers) {
  const RunField whole(one(), -40, -40, 40, 40), part(one(), 3, 3, 20, 20);
  for (int i = 0; i < 500; ++i) {
    const float x = 3 + 0.034f * static_cast<float>(i),
                y = 20 - 0.017f * static_cast<float>(i % 700);
    ASSERT_EQ(whole.at(x, y, 0).time, part.at(x, y, 0).time);
    ASSERT_EQ(whole.at(x, y, 0).strength, part.at(x, y, 0).strength);
    ASSERT_EQ(whole.at(x, y, 0).source_mm, part.at(x, y, 0).source_mm);
  }
}

TEST(RunField, ACoarseTexelSeesTheSameAmountOfStain) {
  const RunField field(one(), 0, 0, 60, 60);
  double fine = 0, coarse = 0;
  for (float x = 4; x < 56; x += 0.1f)
    for (float y = 4; y < 56; y += 0.5f) {
      fine += field.at(x, y, 0).strength;
      coarse += field.at(x, y, 1.0f).strength;
    }
  EXPECT_NEAR(coarse / fine, 1, 0.06);
}

}  // namespace
}  // namespace patina::devices::twin
