// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/nearness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace patina::patch {
namespace {

constexpr SizePx kSource{64, 64}, kTarget{160, 128};  // cells of 4 x 4 texels

// Shows the source cell around (20, 20) with its upper left corner at (x, y).
void showCell(Nearness& nearness, int x, int y) {
  for (int dy = 0; dy < 4; ++dy)
    for (int dx = 0; dx < 4; ++dx)
      nearness.add(x + dx, y + dy, (20 + dy) * kSource.width + 20 + dx);
}
constexpr int kCentre = 21 * kSource.width + 21;

TEST(Nearness, IsMoreTheNearerACopyIsAndNothingAwayFromIt) {
  Nearness nearness(kSource, kTarget, false, 0, kTarget.width);
  showCell(nearness, 80, 60);
  const int next = nearness.at(80 + 8, 60, kCentre), further = nearness.at(80 + 24, 60, kCentre);
  EXPECT_GT(next, 0.7 * nearness.unit());
  EXPECT_LT(next, nearness.unit());
  EXPECT_GT(further, 0.3 * nearness.unit());
  EXPECT_LT(further, next);
  EXPECT_EQ(nearness.at(80 + 48, 60, kCentre), 0);
  EXPECT_EQ(nearness.at(80 + 8, 60, 40 * kSource.width + 40), 0);
}

TEST(Nearness, LeavesOutTheCopyThatGoesOn) {
  Nearness nearness(kSource, kTarget, false, 0, kTarget.width);
  showCell(nearness, 82, 62);
  for (int dy = 0; dy < 4; ++dy)
    for (int dx = 0; dx < 4; ++dx) EXPECT_EQ(nearness.at(82 + dx, 62 + dy, kCentre), 0);
}

TEST(Nearness, ForgetsWhatIsNoLongerShown) {
  Nearness nearness(kSource, kTarget, false, 0, kTarget.width);
  nearness.add(80, 60, kCentre);
  nearness.remove(80, 60, kCentre);
  for (int y = 0; y < kTarget.height; y += 4)
    for (int x = 0; x < kTarget.width; x += 4) ASSERT_EQ(nearness.at(x, y, kCentre), 0);
}

TEST(Nearness, SeesTheOtherSideOnlyWhereTheTargetWraps) {
  for (const bool wraps : {false, true}) {
    Nearness nearness(kSource, kTarget, wraps, 0, kTarget.width);
    showCell(nearness, 156, 124);
    EXPECT_EQ(nearness.at(4, 4, kCentre) > 0, wraps);
    EXPECT_EQ(nearness.at(148, 4, kCentre) > 0, wraps);
    EXPECT_GT(nearness.at(144, 116, kCentre), 0);
  }
}

TEST(Nearness, IsTheSameInTheBandThatAsks) {
  Nearness whole(kSource, kTarget, true, 0, kTarget.width), band(kSource, kTarget, true, 96, 160);
  for (int x = 0; x < kTarget.width; x += 12) {
    showCell(whole, x, (7 * x) % 120);
    showCell(band, x, (7 * x) % 120);
  }
  for (int y = 0; y < kTarget.height; ++y)
    for (int x = 96; x < 160; ++x)
      ASSERT_EQ(band.at(x, y, kCentre), whole.at(x, y, kCentre)) << x << " " << y;
}

// Every patch is counted at every distance: no row of weights ends early.
TEST(Nearness, IsTheSameInAllDirections) {
  Nearness nearness(kSource, kTarget, false, 0, kTarget.width);
  showCell(nearness, 80, 60);
  for (int d = 1; d <= 12; ++d)
    for (int e = 0; e <= 12 && 60 + 4 * d < kTarget.height; ++e) {
      const int right = nearness.at(80 + 4 * d, 60 + 4 * std::min(e, d), kCentre);
      EXPECT_EQ(nearness.at(80 - 4 * d, 60 + 4 * std::min(e, d), kCentre), right);
      EXPECT_EQ(nearness.at(80 + 4 * std::min(e, d), 60 + 4 * d, kCentre), right);
      EXPECT_EQ(nearness.at(80 - 4 * std::min(e, d), 60 - 4 * d, kCentre), right);
      const double apart = std::hypot(d, std::min(e, d));
      if (apart > 1.5 && apart < 11.5) {
        EXPECT_GT(right, 0) << d << " " << e;
      }
    }
}

TEST(Nearness, TellsItsBytes) {
  EXPECT_GT(Nearness::bytes(kSource, kTarget), 256 * 40 * 32 * 4);
  EXPECT_GT(Nearness::bytes({512, 512}, {32768, 32768}), 1 << 30);
}

}  // namespace
}  // namespace patina::patch
