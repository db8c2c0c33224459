// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/euclidean.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

// Two channels of cubic polynomials a texel.
Image<float> cubics(int side) {
  Image<float> out(side, side, 8);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(gaussian(hashSeed(1, i)));
  return out;
}
std::vector<double> hilbert() {
  std::vector<double> gram;
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) gram.push_back(1.0 / (i + j + 1));
  return gram;
}

double squared(const Image<float>& image, int x0, int y0, int x1, int y1) {
  double sum = 0;
  for (int c = 0; c < image.channels(); ++c)
    sum += std::pow(double{image.at(x0, y0, c)} - image.at(x1, y1, c), 2);
  return sum;
}

// Meister et al. 2021, eq. 11, by a fine sum.
double integral(const Image<float>& cubic, int channel, int x0, int y0, int x1, int y1) {
  constexpr int kSteps = 4000;
  double sum = 0;
  for (int s = 0; s < kSteps; ++s) {
    const double t = (s + 0.5) / kSteps;
    double d = 0;
    for (int k = 3; k >= 0; --k)
      d = d * t + (cubic.at(x0, y0, 4 * channel + k) - cubic.at(x1, y1, 4 * channel + k));
    sum += d * d / kSteps;
  }
  return sum;
}

TEST(Euclidean, MakesSquaredDifferencesTheIntegralOverTime) {
  const Image<float> cubic = cubics(4);
  const std::vector<double> weights{1, 0.25};
  const Image<float> features = euclidean(cubic.view(), hilbert(), weights);
  EXPECT_EQ(features.channels(), 8);
  for (int i = 0; i < 10; ++i) {
    const int x = i % 4, y = i / 4;
    EXPECT_NEAR(squared(features, x, y, 3, 3),
                integral(cubic, 0, x, y, 3, 3) + 0.25 * integral(cubic, 1, x, y, 3, 3), 1e-4);
  }
}

TEST(Euclidean, LeavesChannelsWithoutWeightOut) {
  const Image<float> cubic = cubics(2);
  EXPECT_EQ(euclidean(cubic.view(), hilbert(), std::vector<double>{0, 1}).channels(), 4);
  EXPECT_THROW(euclidean(cubic.view(), hilbert(), std::vector<double>{0, 0}), ProcessingError);
  EXPECT_THROW(euclidean(cubic.view(), hilbert(), std::vector<double>{1, -1}), ProcessingError);
}

double squared(const Image<std::int16_t>& image, int x0, int y0, int x1, int y1) {
  double sum = 0;
  for (int c = 0; c < image.channels(); ++c)
    sum += std::pow(image.at(x0, y0, c) - image.at(x1, y1, c), 2);
  return sum;
}

// Twenty directions matter less and less: the leading part is a bound below, all parts are exact.
TEST(CompactFeatures, BoundTheDistanceAndHoldAllOfIt) {
  Image<float> features(30, 30, 20);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x)
      for (int c = 0; c < 20; ++c)
        features.at(x, y, c) = static_cast<float>(gaussian(hashSeed(x, y, c)) / (1 + c));
  Progress progress;
  const CompactFeatures compact = compactFeatures(features.view(), {}, 5, progress);
  ASSERT_EQ(compact.parts.size(), 3u);
  EXPECT_EQ(compact.parts[0].texels.channels(), 8);
  EXPECT_EQ(compact.parts[1].texels.channels(), 8);
  EXPECT_EQ(compact.parts[2].texels.channels(), 4);
  double least_share = 1;
  for (int i = 0; i < 200; ++i) {
    const int x = i % 30, y = i / 30;
    const double exact = squared(features, x, y, 29, 29) * compact.scale * compact.scale,
                 leading = squared(compact.parts[0].texels, x, y, 29, 29);
    double all = 0;
    for (const CompactPart& part : compact.parts) all += squared(part.texels, x, y, 29, 29);
    EXPECT_NEAR(all, exact, 0.01 * exact + 20);
    EXPECT_LE(leading, all);
    least_share = std::min(least_share, leading / all);
  }
  EXPECT_LT(least_share, 0.9);
}

TEST(CompactFeatures, TakeFewerChannelsThanComponents) {
  Image<float> features(6, 6, 3);
  features.at(2, 3, 1) = 1;
  Progress progress;
  const CompactFeatures compact = compactFeatures(features.view(), {}, 3, progress);
  EXPECT_EQ(compact.parts[0].texels.channels(), 4);
  EXPECT_EQ(compact.parts[0].texels.at(2, 3, 3), 0);
}

TEST(CompactFeatures, AreFourWhereTheRestIsNothing) {
  Image<float> features(30, 30, 12, 0.04f);
  for (int y = 0; y < 30; ++y)
    for (int x = 0; x < 30; ++x)
      for (int c = 0; c < 4; ++c)
        features.at(x, y, c) = static_cast<float>(gaussian(hashSeed(x, y, c)));
  Progress progress;
  EXPECT_EQ(compactFeatures(features.view(), {}, 5, progress).parts[0].texels.channels(), 4);
  for (int i = 0; i < 30; ++i)
    features.at(i, 7, 4) = 0.1f * static_cast<float>(gaussian(hashSeed(i)));
  EXPECT_EQ(compactFeatures(features.view(), {}, 5, progress).parts[0].texels.channels(), 8);
}

TEST(CompactFeatures, MeasureGuidesOnOneScaleWithTheRest) {
  Image<float> features(20, 20, 3), from(20, 20, 2), to(30, 25, 2);
  const auto fill = [](Image<float>& image, std::uint64_t seed) {
    for (std::size_t i = 0; i < image.texels().size(); ++i)
      image.texels()[i] = static_cast<float>(gaussian(hashSeed(seed, i)));
  };
  fill(features, 1);
  fill(from, 2);
  fill(to, 3);
  Progress progress;
  const CompactFeatures compact =
      compactFeatures(features.view(), {from.view(), to.view()}, 5, progress);
  ASSERT_EQ(compact.parts[0].texels.channels(), 16);
  ASSERT_EQ(compact.parts[0].guide.size(), to.size());
  double exact = 0, ours = 0;
  for (int c = 0; c < 2; ++c) exact += std::pow(from.at(4, 7, c) - to.at(22, 11, c), 2);
  for (int c = 0; c < 8; ++c)
    ours +=
        std::pow(compact.parts[0].texels.at(4, 7, 8 + c) - compact.parts[0].guide.at(22, 11, c), 2);
  EXPECT_NEAR(ours / compact.scale / compact.scale, exact, 0.01 * exact);
}

TEST(CompactFeatures, HoldEveryGuide) {
  Image<float> features(20, 20, 3), from(20, 20, 20), to(30, 25, 20);
  for (std::size_t i = 0; i < from.texels().size(); ++i)
    from.texels()[i] = static_cast<float>(gaussian(hashSeed(2, i)));
  for (std::size_t i = 0; i < to.texels().size(); ++i)
    to.texels()[i] = static_cast<float>(gaussian(hashSeed(3, i)));
  Progress progress;
  const CompactFeatures compact =
      compactFeatures(features.view(), {from.view(), to.view()}, 5, progress);
  ASSERT_EQ(compact.parts.size(), 3u);
  double exact = 0, ours = 0;
  for (int c = 0; c < 20; ++c) exact += std::pow(from.at(4, 7, c) - to.at(22, 11, c), 2);
  for (const CompactPart& part : compact.parts)
    for (int c = 0; c < 8; ++c)
      ours += std::pow(
          part.texels.at(4, 7, part.texels.channels() - 8 + c) - part.guide.at(22, 11, c), 2);
  EXPECT_NEAR(ours / compact.scale / compact.scale, exact, 0.01 * exact);
}

}  // namespace
}  // namespace patina::patch
