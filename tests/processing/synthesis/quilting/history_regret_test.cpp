// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/history_regret.h"

#include <gtest/gtest.h>

#include <limits>

#include "processing/image/encoding.h"
#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

constexpr SizePx kBlock{14, 12}, kOverlap{5, 4};

// Equation 3, frame by frame, for one corner.
double costOf(const std::vector<Image<float>>& frames, const std::vector<float>& weight,
              const Placement& place, PointPx corner) {
  double sum = 0;
  for (std::size_t t = 0; t < frames.size(); ++t) {
    for (int y = 0; y < kBlock.height; ++y)
      for (int x = 0; x < kBlock.width; ++x) {
        if (x >= kOverlap.width && y >= kOverlap.height) continue;
        const PointPx from = y < kOverlap.height ? place.whole : place.left;
        for (int c = 0; c < 3; ++c) {
          const double apart = weight[t] * (frames[t].at(from.x + x, from.y + y, c) -
                                            frames[t].at(corner.x + x, corner.y + y, c));
          sum += apart * apart;
        }
      }
  }
  return sum;
}

TEST(HistoryRegret, IsThatOfEquationThreeByBruteForce) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 5, {40, 36});
  const ttf::TtfReader input(folder / "in.h5");
  const QuiltingSource source(input, nullptr);
  std::vector<Image<float>> frames;
  for (int t = 0; t < 5; ++t) {
    frames.push_back(source.linearFrame(t));
    for (float& v : frames.back().texels()) v = srgbFromLinear(v);
  }
  const std::vector<float> weight{1, 2, 0.5f, 1, 3};
  const std::vector<Placement> placements = drawPlacements({27, 25}, 6, 3);
  RankRegret some{2, 0, 0}, best{3, 0, 0};
  double expected = 0;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    double least = std::numeric_limits<double>::infinity();
    PointPx at{};
    for (int y = 0; y <= 36 - kBlock.height; ++y)
      for (int x = 0; x <= 40 - kBlock.width; ++x) {
        const double cost = costOf(frames, weight, placements[i], {x, y});
        if (cost < least) {
          least = cost;
          at = {x, y};
        }
      }
    best.choices.push_back(at);
    some.choices.push_back(placements[i].whole);
    expected += (costOf(frames, weight, placements[i], some.choices.back()) - least) / least / 6;
  }
  Progress progress;
  const auto of = [&](const RankRegret& chosen) {
    return historyRegret(source, weight, kBlock, kOverlap, placements, {chosen}, progress).at(0);
  };
  EXPECT_GT(expected, 0.01);
  EXPECT_NEAR(of(some).mean, expected, 1e-4 * expected);
  EXPECT_LT(of(some).same_share, 1);
  EXPECT_NEAR(of(best).mean, 0, 1e-9);
  EXPECT_EQ(of(best).same_share, 1);
}

}  // namespace
}  // namespace patina::quilting
