// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/wakefulness.h"

#include <gtest/gtest.h>

#include <numeric>

namespace patina::patch {
namespace {

constexpr SizePx kSize{9, 7};
std::size_t at(int x, int y) {
  const int index = y * kSize.width + x;
  return static_cast<std::size_t>(index);
}

int awakeOf(const Wakefulness& w) {
  int count = 0;
  for (std::size_t i = 0; i < at(0, kSize.height); ++i) count += w.awake(i);
  return count;
}

TEST(Wakefulness, KeepsTheNeighboursOfAChangeAwakeForSoManyPasses) {
  Wakefulness w(kSize, false, 2);
  w.beginPass();
  EXPECT_EQ(awakeOf(w), 0);
  w.noteChange(at(4, 3));
  EXPECT_TRUE(w.changedNow(at(4, 3)));
  for (const int awake : {9, 9, 0}) {
    w.beginPass();
    EXPECT_EQ(awakeOf(w), awake);
    EXPECT_FALSE(w.changedNow(at(4, 3)));
  }
}

TEST(Wakefulness, WakesAll) {
  Wakefulness w(kSize, false, 1);
  w.wakeAll();
  w.beginPass();
  EXPECT_EQ(awakeOf(w), 63);
  w.beginPass();
  EXPECT_EQ(awakeOf(w), 0);
}

TEST(Wakefulness, WakesOnlyWhatItIsToldAndItsNeighbours) {
  Wakefulness w(kSize, false, 1);
  w.wakeAll();
  std::vector<std::uint8_t> map(63, 0);
  map[at(0, 0)] = 1;
  w.wakeOnly(map);
  w.beginPass();
  EXPECT_EQ(awakeOf(w), 4);
  const std::vector<std::uint8_t> votes = w.takeChangesWithin(0);
  EXPECT_EQ(std::accumulate(votes.begin(), votes.end(), 0), 63);
}

TEST(Wakefulness, SpreadsOverTheEdgeOnlyWhenItWraps) {
  for (const bool wraps : {false, true}) {
    Wakefulness w(kSize, wraps, 1);
    w.noteChange(at(0, 0));
    const std::vector<std::uint8_t> near = w.takeChangesWithin(2);
    EXPECT_EQ(std::accumulate(near.begin(), near.end(), 0), wraps ? 25 : 9);
    EXPECT_EQ(near[at(7, 6)], wraps);
    EXPECT_EQ(near[at(2, 2)], 1);
    EXPECT_EQ(near[at(3, 0)], 0);
  }
}

TEST(Wakefulness, ForgetsTheChangesThatWereTaken) {
  Wakefulness w(kSize, false, 3);
  w.noteChange(at(1, 1));
  w.takeChangesWithin(1);
  const std::vector<std::uint8_t> again = w.takeChangesWithin(1);
  EXPECT_EQ(std::accumulate(again.begin(), again.end(), 0), 0);
}

TEST(Wakefulness, RemembersWhoChangedLately) {
  Wakefulness w(kSize, false, 2);
  w.noteChange(at(4, 3));
  for (const bool lately : {true, true, false}) {
    w.beginPass();
    EXPECT_EQ(w.changedLately(at(4, 3)), lately);
    EXPECT_FALSE(w.changedLately(at(5, 3)));
  }
}

}  // namespace
}  // namespace patina::patch
