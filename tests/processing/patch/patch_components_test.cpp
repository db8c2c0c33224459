// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/patch_components.h"

#include <gtest/gtest.h>

#include <climits>
#include <cmath>
#include <vector>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

constexpr SizePx kSource{20, 17}, kTarget{9, 8};

Image<std::int16_t> noise(SizePx size, int channels, std::uint64_t seed) {
  Image<std::int16_t> out(size.width, size.height, channels);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<std::int16_t>(uniformBelow(hashSeed(seed, i), 2000));
  return out;
}

std::vector<std::int32_t> centres() {
  std::vector<std::int32_t> out;
  for (std::uint64_t i = 0; i < 72; ++i)
    out.push_back(static_cast<std::int32_t>((2 + uniformBelow(hashSeed(i, 1), 13)) * 20 + 2 +
                                            uniformBelow(hashSeed(i, 2), 16)));
  return out;
}

// What is at target texel (x, y): the first component, and the last.
std::vector<int> texel(const PatchComponents& components, int x, int y, int channels) {
  const std::int16_t* at =
      components.patchAt(x, y) + 2 * (std::ptrdiff_t{kTarget.width + 4} * channels + channels);
  return {at[0], at[channels - 1]};
}

TEST(PatchComponents, VoteTheMeanAndLeaveGuidesAsTheyAre) {
  for (const int channels : {4, 8, 16}) {
    const Image<std::int16_t> source = noise(kSource, channels, 1), own = noise(kTarget, 8, 2);
    const std::vector<std::int32_t> shown = centres();
    const Votes votes{shown, kTarget, kSource.width, 2, true, {}};
    for (const bool guided : {false, true}) {
      if (guided && channels < 16) continue;
      PatchComponents components(source.view(), kTarget, 5,
                                 guided ? own.view() : ImageView<const std::int16_t>{});
      for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 9; ++x) {
          components.vote(votes, x, y);
          double first = 0, last = 0;
          const int count = forEachVote(votes, x, y, [&](std::int32_t at, int, int) {
            first += source.at(at % 20, at / 20, 0);
            last += source.at(at % 20, at / 20, channels - 1);
          });
          const std::vector<int> is = texel(components, x, y, channels);
          ASSERT_NEAR(is[0], first / count, 0.51);
          ASSERT_NEAR(is[1], guided ? own.at(x, y, 7) : last / count, guided ? 0 : 0.51);
        }
    }
  }
}

TEST(PatchComponents, GoOnBeyondTheEdgeAsTheTargetDoes) {
  const Image<std::int16_t> source = noise(kSource, 8, 1);
  const std::vector<std::int32_t> shown = centres();
  for (const bool wraps : {false, true}) {
    const Votes votes{shown, kTarget, kSource.width, 2, wraps, {}};
    PatchComponents components(source.view(), kTarget, 5, {});
    for (int y = 0; y < 8; ++y)
      for (int x = 0; x < 9; ++x) components.vote(votes, x, y);
    components.pad(wraps);
    EXPECT_EQ(texel(components, -2, 3, 8), texel(components, wraps ? 7 : 0, 3, 8));
    EXPECT_EQ(texel(components, 10, 3, 8), texel(components, wraps ? 1 : 8, 3, 8));
    EXPECT_EQ(texel(components, 4, -1, 8), texel(components, 4, wraps ? 7 : 0, 8));
    EXPECT_EQ(texel(components, -1, 9, 8), texel(components, wraps ? 8 : 0, wraps ? 1 : 7, 8));
  }
}

TEST(PatchComponents, AreNoDistanceFromWhatTheyShow) {
  const Image<std::int16_t> source = noise(kSource, 16, 1);
  std::vector<std::int32_t> copy;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 9; ++x) copy.push_back((y + 4) * 20 + x + 5);
  const Votes votes{copy, kTarget, kSource.width, 2, false, {}};
  PatchComponents components(source.view(), kTarget, 5, {});
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 9; ++x) components.vote(votes, x, y);
  EXPECT_EQ(components.distance(components.patchAt(4, 3), 7 * 20 + 9, INT_MAX), 0);
  EXPECT_GT(components.distance(components.patchAt(4, 3), 7 * 20 + 10, INT_MAX), 1000);
}

}  // namespace
}  // namespace patina::patch
