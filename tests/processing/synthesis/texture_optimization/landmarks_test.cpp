// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/texture_optimization/landmarks.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>

#include "processing/image/progress.h"
#include "processing/image/random.h"
#include "processing/synthesis/texture_optimization/copies.h"
#include "processing/synthesis/texture_optimization/optimize.h"

namespace patina::texture_optimization {
namespace {

constexpr int kSide = 48;

// Noise, and discs of a brightness found nowhere else at the places given.
struct Disc {
  int x, y;
};
Image<std::int16_t> noiseWith(const std::vector<Disc>& discs, int side = kSide) {
  Image<std::int16_t> out(side, side, 4);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      out.at(x, y, 0) = static_cast<std::int16_t>(
          200 * uniform(hashSeed(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y))));
      for (const Disc disc : discs)
        if (std::hypot(x - disc.x, y - disc.y) < side / 12.0) out.at(x, y, 0) = 900;
    }
  return out;
}

TEST(Landmarks, AreWhatIsFoundNowhereElse) {
  EXPECT_EQ(landmarksOf(noiseWith({}).view()).count, 0);
  const Landmarks one = landmarksOf(noiseWith({{30, 14}}).view());
  EXPECT_EQ(one.count, 1);
  EXPECT_EQ(one.at(30, 14, {kSide, kSide}), 0);
  EXPECT_EQ(one.at(61, 29, {2 * kSide, 2 * kSide}), 0);
  EXPECT_EQ(one.at(10, 40, {kSide, kSide}), -1);
  const Landmarks two_alike = landmarksOf(noiseWith({{30, 14}, {12, 36}}).view());
  EXPECT_EQ(two_alike.at(30, 14, {kSide, kSide}), -1);
}

// One bright texel nearly makes a patch stand out, two do.
TEST(Landmarks, AreThereForAPatchThatStandsOutAndReachAsFarAsThoseThatNearlyDo) {
  constexpr std::int16_t kBright = 440;
  Image<std::int16_t> sample = noiseWith({});
  sample.at(24, 20, 0) = kBright;
  EXPECT_EQ(landmarksOf(sample.view()).count, 0);
  sample.at(28, 20, 0) = kBright;
  const Landmarks both = landmarksOf(sample.view());
  EXPECT_EQ(both.count, 1);
  EXPECT_EQ(both.at(26, 20, {kSide, kSide}), 0);
  EXPECT_EQ(both.at(24, 20, {kSide, kSide}), 0);  // shows one of them
  EXPECT_EQ(both.at(32, 20, {kSide, kSide}), -1);
}

TEST(Landmarks, AreFoundAtTheEdgeAndInSamplesOfAnyShape) {
  EXPECT_EQ(landmarksOf(noiseWith({{0, 20}}).view()).at(0, 20, {kSide, kSide}), 0);
  EXPECT_EQ(landmarksOf(Image<std::int16_t>(kSide, kSide, 4).view()).count, 0);
  EXPECT_EQ(landmarksOf(Image<std::int16_t>(2, 9, 4).view()).count, 0);
  EXPECT_EQ(landmarksOf(Image<std::int16_t>(5, 3000, 4).view()).count, 0);
}

TEST(Landmarks, AreTheSameForAnyNumberOfThreads) {
  std::vector<std::vector<std::int32_t>> of;
  for (const int threads : {1, 2, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    of.push_back(landmarksOf(noiseWith({{30, 14}, {9, 40}}, 64).view()).of);
  }
  EXPECT_EQ(of[0], of[1]);
  EXPECT_EQ(of[0], of[2]);
}

TEST(Landmarks, MayBeShownWhereTheyAreAndATexelAround) {
  Landmarks landmarks{.size = {8, 8}, .count = 1, .of = std::vector<std::int32_t>(64, -1)};
  landmarks.of[5 * 8 + 5] = 0;  // of 4x4 texels, the one at 2,2
  std::vector<std::int32_t> shown(36, 0);
  shown[2 * 6 + 3] = 2 * 4 + 2;
  const std::vector<patch::Labels::Copy> in = landmarksIn(shown, {6, 6}, {4, 4}, landmarks);
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 6; ++x)
      EXPECT_EQ(in[static_cast<std::size_t>(y * 6 + x)].label,
                std::abs(x - 3) <= 1 && std::abs(y - 2) <= 1 ? 0 : -1);
  // Twelve times as fine: a 24th of 48 texels beside its place.
  const patch::Labels fine = labelsOf(landmarks, in, {6, 6}, 12, {48, 48}, {72, 72}, false);
  for (int y = 0; y < 72; ++y)
    for (int x = 0; x < 72; ++x)
      EXPECT_EQ(fine.refuse(32 * 48 + 32, static_cast<std::size_t>(y * 72 + x)),
                std::abs(x - 44) > 2 || std::abs(y - 32) > 2)
          << x << "," << y;
}

// The whole way from the layout to the finest level.
TEST(Landmarks, LieTheSamplesSideApart) {
  const Image<std::int16_t> sample = noiseWith({{60, 30}}, 96);
  Image<float> features(96, 96, 3);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x)
      for (int c = 0; c < 3; ++c)
        features.at(x, y, c) = static_cast<float>(sample.at(x, y, 0)) / 1000;
  for (const std::uint64_t seed : {1u, 2u, 3u}) {
    OptimizeOptions options;
    options.size = {192, 192};
    options.rounds = 4;
    options.field.seed = seed;
    Progress progress;
    const OptimizedField field = optimize(features.view(), options, {}, progress);
    EXPECT_GT(field.landmarks.count, 0);
    const double apart = landmarksApart(field);
    EXPECT_TRUE(apart == 0 || apart > 0.9) << apart;
  }
}

}  // namespace
}  // namespace patina::texture_optimization
