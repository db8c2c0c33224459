// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/ttf_features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "processing/image/encoding.h"
#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

// Standard deviation of a frame as displayed, over its channels.
double contrastOf(const Image<float>& frame) {
  double variance = 0;
  for (int c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    for (std::size_t i = c; i < frame.texels().size(); i += 3) {
      const double v = srgbFromLinear(frame.texels()[i]);
      sum += v;
      squares += v * v;
    }
    const double n = frame.texels().size() / 3.0;
    variance += squares / n - sum / n * sum / n;
  }
  return std::sqrt(variance);
}

TEST(TtfFeatures, DistancesAreThoseOfWholeHistoriesAsDisplayedEachFrameAgainstItsContrast) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {150, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const TtfFeatures f = ttfFeatures(QuiltingSource(input, nullptr), 27, {}, progress);
  ASSERT_EQ(f.features.channels(), 27);
  std::vector<Image<float>> frames;
  std::vector<double> contrast;
  for (int t = 0; t < 9; ++t) {
    frames.push_back(input.linearFrame(t));
    contrast.push_back(contrastOf(frames.back()));
  }
  const double strongest = *std::max_element(contrast.begin(), contrast.end());
  for (auto [a, b] : {std::pair{3, 149}, {0, 128}, {127, 60}}) {
    double histories = 0, features = 0;
    for (int t = 0; t < 9; ++t)
      for (int c = 0; c < 3; ++c) {
        const double weight = 1.2 * strongest / (contrast[t] + 0.2 * strongest);
        histories += std::pow(weight * (srgbFromLinear(frames[t].at(a, 7, c)) -
                                        srgbFromLinear(frames[t].at(b, 20, c))),
                              2);
      }
    for (int k = 0; k < 27; ++k)
      features += std::pow(f.features.at(a, 7, k) - f.features.at(b, 20, k), 2);
    EXPECT_NEAR(features, histories, 1e-3 * histories + 1e-7);
  }
}

TEST(TtfFeatures, TakesTheRankByErrorAndNeverMoreThanThereIs) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {40, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  EXPECT_LE(ttfFeatures(QuiltingSource(input, nullptr), 15, 0.05, progress).features.channels(), 3);
  EXPECT_EQ(ttfFeatures(QuiltingSource(input, nullptr), 500, {}, progress).features.channels(), 27);
}

TEST(TtfFeatures, GiveTheDisplayedHistoryBackThroughTheirBasis) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {60, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const TtfFeatures f = ttfFeatures(QuiltingSource(input, nullptr), 27, {}, progress);
  ASSERT_EQ(f.basis.size(), 27u * 27u);
  ASSERT_EQ(f.weight.size(), 9u);
  const auto displayed = [&](int t, int x, int y) {
    return srgbFromLinear(input.linearFrame(t).at(x, y, 1));
  };
  for (int t : {0, 4, 8}) {
    double step = 0;
    for (int k = 0; k < 27; ++k)
      step += f.basis[(t * 3 + 1) * 27 + k] * (f.features.at(41, 20, k) - f.features.at(7, 3, k));
    EXPECT_NEAR(step / f.weight[t], displayed(t, 41, 20) - displayed(t, 7, 3), 1e-4);
  }
}

TEST(TtfFeatures, OfChannelsApartKeepTheSameDistancesAndGiveHistoriesBack) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {60, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const QuiltingSource source(input, nullptr);
  const TtfFeatures joint = ttfFeatures(source, 27, {}, progress),
                    apart = ttfFeaturesApart(source, 27, {}, progress);
  ASSERT_EQ(apart.features.channels(), 27);
  EXPECT_NEAR(apart.relative_error, 0, 1e-3);
  const auto distance = [](const TtfFeatures& f) {
    double sum = 0;
    for (int k = 0; k < 27; ++k)
      sum += std::pow(f.features.at(41, 20, k) - f.features.at(7, 3, k), 2);
    return sum;
  };
  EXPECT_NEAR(distance(apart), distance(joint), 1e-3 * distance(joint));
  for (int t : {0, 4, 8}) {
    double value = apart.mean[t * 3 + 1];
    for (int k = 0; k < 27; ++k)
      value += apart.basis[(t * 3 + 1) * 27 + k] * apart.features.at(41, 20, k);
    EXPECT_NEAR(value / apart.weight[t], srgbFromLinear(input.linearFrame(t).at(41, 20, 1)), 1e-4);
  }
}

TEST(TtfFeatures, OfChannelsApartShareTheRankAndTellItsError) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 9, {40, 30});
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const QuiltingSource source(input, nullptr);
  const TtfFeatures six = ttfFeaturesApart(source, 6, {}, progress),
                    three = ttfFeaturesApart(source, 3, {}, progress);
  EXPECT_EQ(six.features.channels(), 6);
  EXPECT_LT(six.relative_error, three.relative_error);
  EXPECT_GE(six.relative_error, ttfFeatures(source, 6, {}, progress).relative_error - 1e-6);
}

}  // namespace
}  // namespace patina::quilting
