// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/usable_patches.h"

#include <gtest/gtest.h>

#include <numeric>

#include "processing/image/failure.h"

namespace patina::patch {
namespace {

TEST(UsablePatches, AreThoseInside) {
  const std::vector<std::uint8_t> usable = usablePatches({}, {9, 7}, 5);
  EXPECT_EQ(std::accumulate(usable.begin(), usable.end(), 0), 5 * 3);
  EXPECT_EQ(usable[2 * 9 + 2], 1);
  EXPECT_EQ(usable[2 * 9 + 1], 0);
}

TEST(UsablePatches, CoverNoMaskedTexel) {
  std::vector<std::uint8_t> texels(9 * 7, 1);
  texels[3 * 9 + 3] = 0;
  const std::vector<std::uint8_t> usable = usablePatches(texels, {9, 7}, 3);
  EXPECT_EQ(std::accumulate(usable.begin(), usable.end(), 0), 7 * 5 - 9);
  EXPECT_EQ(usable[4 * 9 + 4], 0);
  EXPECT_EQ(usable[5 * 9 + 3], 1);
}

TEST(UsablePatches, HaveToBeThere) {
  const std::vector<std::uint8_t> none(9 * 7, 0);
  EXPECT_THROW(usablePatches(none, {9, 7}, 3), ProcessingError);
  EXPECT_THROW(usablePatches({}, {4, 7}, 5), ProcessingError);
}

}  // namespace
}  // namespace patina::patch
