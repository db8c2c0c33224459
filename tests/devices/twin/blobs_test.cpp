// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/blobs.h"

#include <gtest/gtest.h>

namespace patina::devices::twin {
namespace {

const Rim kSharp{0.001f, 0.0f, 0.5f};

BlobOptions everywhere() {
  BlobOptions o;
  o.seed = 11;
  o.cell_mm = 4;
  o.radius_min_mm = 3;
  o.radius_max_mm = 4;
  o.onset_min = 0.1f;
  o.onset_max = 0.5f;
  return o;
}

double shareReachedBy(const BlobField& field, float time) {
  int reached = 0;
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 100; ++x) reached += field.at(0.4f * x, 0.4f * y, kSharp, {}).time <= time;
  return reached / 10'000.0;
}

TEST(BlobField, GrowsFromNothingAndMerges) {
  const BlobField field(everywhere(), 0, 0, 40, 40);
  EXPECT_EQ(shareReachedBy(field, 0.05f), 0);
  EXPECT_GT(shareReachedBy(field, 0.5f), 0.02);
  EXPECT_GT(shareReachedBy(field, 0.9f), shareReachedBy(field, 0.5f) + 0.1);
}

TEST(BlobField, DoesNotDependOnTheRectangleItCovers) {
  const BlobField whole(everywhere(), -40, -40, 40, 40), part(everywhere(), 3, 3, 20, 20);
  for (int i = 0; i < 200; ++i) {
    const float x = 3 + 0.085f * i, y = 20 - 0.085f * i;
    ASSERT_EQ(whole.at(x, y, kSharp, {}).time, part.at(x, y, kSharp, {}).time);
  }
}

TEST(BlobField, KeepsAnEarlierArrival) {
  const BlobField field(everywhere(), 0, 0, 40, 40);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(field.at(0.4f * i, 7, kSharp, {0.01f, 0.01f}).time, 0.01f);
}

TEST(BlobField, WidensARimThatRunsSlowly) {
  const BlobField field(everywhere(), 0, 0, 40, 40);
  for (int i = 0; i < 100; ++i) {
    const Arrival a = field.at(0.4f * i, 7, {0.03f, 0.2f, 0.5f}, {});
    if (a.time > 8) continue;
    EXPECT_GE(a.width, 0.03f);
    EXPECT_LE(a.width, 0.5f);
  }
}

TEST(BlobField, HasAsManySpotsAsItsProbabilitySays) {
  BlobOptions some = everywhere();
  some.probability = 0.25f;
  some.radius_min_mm = some.radius_max_mm = 0.5f;
  some.growth = 0.01f;
  // Each spot of radius 0.5 covers pi/4 mm2 once grown; cells are 16 mm2.
  const double share = shareReachedBy(BlobField(some, 0, 0, 40, 40), 0.6f);
  EXPECT_NEAR(share, 0.25 * 0.785 / 16, 0.004);
}

}  // namespace
}  // namespace patina::devices::twin
