// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/similar_patches.h"

#include <gtest/gtest.h>

#include <cstdlib>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

Image<std::int16_t> noise(int side) {
  Image<std::int16_t> out(side, side, 8);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<std::int16_t>(200 * gaussian(hashSeed(4, i)));
  return out;
}

std::vector<std::uint8_t> inside(int side) {
  std::vector<std::uint8_t> out;
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) out.push_back(x >= 2 && x < side - 2 && y >= 2 && y < side - 2);
  return out;
}

TEST(SimilarPatches, FindACopyPlantedElsewhere) {
  Image<std::int16_t> features = noise(40);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x)
      for (int c = 0; c < 8; ++c) features.at(30 + x, 22 + y, c) = features.at(4 + x, 9 + y, c);
  const SimilarPatches similar(features.view(), 5, inside(40), {});
  EXPECT_EQ(similar.of(11 * 40 + 6)[0], 24 * 40 + 32);
  EXPECT_EQ(similar.of(24 * 40 + 32)[0], 11 * 40 + 6);
}

TEST(SimilarPatches, AreApartAndWithinTheSource) {
  const Image<std::int16_t> features = noise(24);
  const SimilarPatches similar(features.view(), 5, inside(24), {.count = 6});
  for (int y = 2; y < 22; ++y)
    for (int x = 2; x < 22; ++x)
      for (int k = 0; k < 6; ++k) {
        const std::int32_t other = similar.of(y * 24 + x)[k];
        if (other < 0) continue;
        const int ox = other % 24, oy = other / 24;
        ASSERT_TRUE(ox >= 2 && ox < 22 && oy >= 2 && oy < 22);
        ASSERT_TRUE(std::abs(ox - x) >= 3 || std::abs(oy - y) >= 3);
      }
}

TEST(SimilarPatches, AreUsable) {
  const Image<std::int16_t> features = noise(24);
  std::vector<std::uint8_t> usable = inside(24);
  for (std::size_t i = 0; i < usable.size(); i += 3) usable[i] = 0;
  const SimilarPatches similar(features.view(), 5, usable, {});
  for (std::size_t i = 0; i < usable.size(); ++i)
    for (int k = 0; k < similar.count(); ++k) {
      const std::int32_t other = similar.of(static_cast<std::int32_t>(i))[k];
      ASSERT_TRUE(other < 0 || (usable[i] != 0 && usable[static_cast<std::size_t>(other)] != 0));
    }
}

TEST(SimilarPatches, AreThoseOfTheLevelAboveTwiceAsFarAway) {
  Image<std::int16_t> features = noise(40);
  for (int y = 0; y < 5; ++y)
    for (int x = 0; x < 5; ++x)
      for (int c = 0; c < 8; ++c) features.at(30 + x, 22 + y, c) = features.at(4 + x, 9 + y, c);
  const SimilarPatches coarse(features.view(), 5, inside(40), {});
  std::vector<std::uint8_t> usable = inside(80);
  const SimilarPatches fine(coarse, {40, 40}, {80, 80}, 5, usable);
  EXPECT_EQ(fine.of(23 * 80 + 12)[0], (23 + 2 * 13) * 80 + 12 + 2 * 26);
  usable[(23 + 2 * 13) * 80 + 12 + 2 * 26] = 0;
  const SimilarPatches masked(coarse, {40, 40}, {80, 80}, 5, usable);
  EXPECT_EQ(masked.of(23 * 80 + 12)[0], fine.of(23 * 80 + 12)[1]);
  for (std::size_t i = 0; i < usable.size(); ++i)
    for (int k = 0; k < masked.count(); ++k) {
      const std::int32_t other = masked.of(static_cast<std::int32_t>(i))[k];
      ASSERT_TRUE(other < 0 || usable[static_cast<std::size_t>(other)] != 0);
    }
}

TEST(SimilarPatches, AreNoneWhereTheSourceIsOnePatch) {
  const SimilarPatches similar(noise(5).view(), 5, inside(5), {});
  EXPECT_EQ(similar.of(2 * 5 + 2)[0], -1);
}

}  // namespace
}  // namespace patina::patch
