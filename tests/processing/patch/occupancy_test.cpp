// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/occupancy.h"

#include <gtest/gtest.h>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

TEST(Occupancy, CountsHowOftenAPatchsTexelsAreShown) {
  for (const int patch : {3, 5, 7}) {
    constexpr int kWidth = 17, kHeight = 13;
    const int reach = patch / 2;
    Occupancy occupancy({kWidth, kHeight}, patch);
    Image<int> covered(kWidth, kHeight, 1);
    for (std::uint64_t i = 0; i < 200; ++i) {
      const int x = reach + static_cast<int>(uniformBelow(hashSeed(i, 1), kWidth - 2 * reach)),
                y = reach + static_cast<int>(uniformBelow(hashSeed(i, 2), kHeight - 2 * reach));
      const bool less = i % 5 == 4;
      less ? occupancy.remove(y * kWidth + x) : occupancy.add(y * kWidth + x);
      for (int dy = -reach; dy <= reach; ++dy)
        for (int dx = -reach; dx <= reach; ++dx) covered.at(x + dx, y + dy) += less ? -1 : 1;
    }
    for (int y = reach; y < kHeight - reach; ++y)
      for (int x = reach; x < kWidth - reach; ++x) {
        int sum = 0;
        for (int dy = -reach; dy <= reach; ++dy)
          for (int dx = -reach; dx <= reach; ++dx) sum += covered.at(x + dx, y + dy);
        ASSERT_EQ(occupancy.at(y * kWidth + x), sum) << patch << " " << x << " " << y;
      }
  }
}

TEST(Occupancy, IsTheSameAllAtOnceAsOneByOne) {
  for (const int patch : {3, 5, 7}) {
    constexpr int kWidth = 19, kHeight = 14;
    const int reach = patch / 2;
    Occupancy one_by_one({kWidth, kHeight}, patch), at_once({kWidth, kHeight}, patch);
    std::vector<std::int32_t> centres;
    for (std::uint64_t i = 0; i < 300; ++i) {
      const int x = reach + static_cast<int>(uniformBelow(hashSeed(i, 1), kWidth - 2 * reach)),
                y = reach + static_cast<int>(uniformBelow(hashSeed(i, 2), kHeight - 2 * reach));
      centres.push_back(y * kWidth + x);
      one_by_one.add(centres.back());
    }
    at_once.addAll(centres);
    for (int y = reach; y < kHeight - reach; ++y)
      for (int x = reach; x < kWidth - reach; ++x)
        ASSERT_EQ(at_once.at(y * kWidth + x), one_by_one.at(y * kWidth + x)) << x << " " << y;
  }
}

}  // namespace
}  // namespace patina::patch
