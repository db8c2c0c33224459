// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/sharp_vote.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "processing/image/random.h"

namespace patina::texture_optimization {
namespace {

constexpr int kSource = 60, kTarget = 40;

Image<float> noise() {
  Image<float> out(kSource, kSource, 8);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(std::lrint(200 * gaussian(hashSeed(1, i))));
  return out;
}

Image<std::int16_t> whole(const Image<float>& image) {
  Image<std::int16_t> out(image.width(), image.height(), image.channels());
  std::transform(image.texels().begin(), image.texels().end(), out.texels().begin(),
                 [](float v) { return static_cast<std::int16_t>(v); });
  return out;
}

// One copy of the source, or two that alternate from patch to patch.
std::vector<std::int32_t> copies(bool alternate) {
  std::vector<std::int32_t> out;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      out.push_back((y + 3) * kSource + x + 4 + (alternate && (x + y) % 2 != 0 ? 11 : 0));
  return out;
}

double varianceInside(const Image<float>& image) {
  double sum = 0, squares = 0, n = 0;
  for (int y = 4; y < kTarget - 4; ++y)
    for (int x = 4; x < kTarget - 4; ++x)
      for (int c = 0; c < image.channels(); ++c, ++n) {
        sum += image.at(x, y, c);
        squares += std::pow(image.at(x, y, c), 2);
      }
  return squares / n - std::pow(sum / n, 2);
}

TEST(SharpVote, IsTheSourceWherePatchesAgree) {
  const Image<float> source = noise();
  const std::vector<std::int32_t> centres = copies(false);
  const patch::Votes votes{centres, {kTarget, kTarget}, kSource, 2};
  const VoteGain gain = contrastLost(whole(source).view(), 8, votes);
  EXPECT_EQ(std::accumulate(gain.gain.begin(), gain.gain.end(), 0.0), kTarget * kTarget);
  const Image<float> out = sharpVote(source.view(), votes, gain);
  EXPECT_EQ(out.at(7, 9, 2), source.at(11, 12, 2));
}

TEST(SharpVote, RestoresTheVarianceThatVotingTakes) {
  const Image<float> source = noise();
  const std::vector<std::int32_t> centres = copies(true);
  const patch::Votes votes{centres, {kTarget, kTarget}, kSource, 2};
  const double plain = varianceInside(sharpVote(source.view(), votes, {})),
               sharp = varianceInside(
                   sharpVote(source.view(), votes, contrastLost(whole(source).view(), 8, votes)));
  EXPECT_NEAR(plain / 40000, 0.5, 0.05);
  EXPECT_NEAR(sharp / 40000, 1, 0.1);
}

// The source's right is its left, brighter: their mean lacks no detail.
TEST(SharpVote, RaisesNothingWhereVotesDifferInBrightnessAlone) {
  Image<float> source = noise();
  for (int y = 0; y < kSource; ++y)
    for (int x = kSource / 2; x < kSource; ++x)
      for (int c = 0; c < 8; ++c) source.at(x, y, c) = source.at(x - kSource / 2, y, c) + 600;
  std::vector<std::int32_t> centres;
  for (int y = 0; y < kTarget; ++y)
    for (int x = 0; x < kTarget; ++x)
      centres.push_back((y + 3) * kSource + 5 + x % 20 + ((x + y) % 2 != 0 ? kSource / 2 : 0));
  const patch::Votes votes{centres, {kTarget, kTarget}, kSource, 2};
  const VoteGain gain = contrastLost(whole(source).view(), 8, votes);
  for (int y = 5; y < kTarget - 5; ++y)
    for (int x = 5; x < 15; ++x)
      ASSERT_LT(gain.gain[static_cast<std::size_t>(y * kTarget + x)], 1.05f) << x << " " << y;
}

TEST(SharpVote, LeavesKeptTexelsAndConstantsAsTheyAre) {
  const Image<float> source = noise(), constant(kSource, kSource, 1, 0.04f);
  const std::vector<std::int32_t> centres = copies(true);
  std::vector<std::int32_t> kept(centres.size(), -1);
  kept[20 * kTarget + 20] = 77;
  const patch::Votes votes{centres, {kTarget, kTarget}, kSource, 2, false, kept};
  const VoteGain gain = contrastLost(whole(source).view(), 8, votes);
  EXPECT_EQ(sharpVote(source.view(), votes, gain).at(20, 20, 5), source.texels()[77 * 8 + 5]);
  const Image<float> flat = sharpVote(constant.view(), votes, gain);
  for (const float v : flat.texels()) ASSERT_NEAR(v, 0.04f, 1e-7);
}

}  // namespace
}  // namespace patina::texture_optimization
