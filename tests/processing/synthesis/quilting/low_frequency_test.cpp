// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/low_frequency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/processing/synthesis/quilting/ttf_texture.h"
#include "tests/support/temp_folder.h"

namespace patina::quilting {
namespace {

using patina::testing::TempFolder;

TEST(LocalLinearSmoother, LeavesStraightLinesAsTheyAreUpToTheEnds) {
  for (int n : {1, 2, 5, 40}) {
    const std::vector<double> smoother = localLinearSmoother(n, 4);
    for (int i = 0; i < n; ++i) {
      double sum = 0, line = 0;
      for (int j = 0; j < n; ++j) {
        sum += smoother[i * n + j];
        line += smoother[i * n + j] * (3 + 2 * j);
      }
      EXPECT_NEAR(sum, 1, 1e-9);
      EXPECT_NEAR(line, 3 + 2 * i, 1e-6) << n << " " << i;
    }
  }
}

double rampOf(int x, int y, double s) { return 0.6 + 0.004 * x + s * 0.002 * y; }

// Mean of a block of texels.
double meanOf(const Image<float>& frame, int x0, int y0) {
  double sum = 0;
  for (int y = y0; y < y0 + 40; ++y)
    for (int x = x0; x < x0 + 40; ++x) sum += frame.at(x, y, 1);
  return sum / 1600;
}

TEST(LowFrequency, TakesARampThatComesWithTimeOutOfEveryFrameUpToItsCorners) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 5, {200, 160}, ttf::SampleType::kF32, rampOf);
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const LowFrequency low(input, 40, progress);
  for (int t : {0, 4}) {
    Image<float> frame = input.linearFrame(t);
    const double before = meanOf(frame, 160, 120) / meanOf(frame, 0, 0);
    low.takeOut(t, {0, 0, 200, 160}, &frame.at(0, 0));
    EXPECT_GT(before, 1.5);
    EXPECT_NEAR(meanOf(frame, 160, 120) / meanOf(frame, 0, 0), 1, 0.03);
  }
}

TEST(LowFrequency, LeavesWhatIsFasterThanItsSigma) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {200, 160}, ttf::SampleType::kF32);
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const LowFrequency low(input, 60, progress);
  const Image<float> before = input.linearFrame(0);
  Image<float> after = before;
  low.takeOut(0, {0, 0, 200, 160}, &after.at(0, 0));
  double change = 0, contrast = 0;
  for (int y = 1; y < 160; ++y)
    for (int x = 1; x < 200; ++x) {
      const double step = before.at(x, y, 0) - before.at(x - 1, y, 0);
      change += std::pow(after.at(x, y, 0) - after.at(x - 1, y, 0) - step, 2);
      contrast += step * step;
    }
  EXPECT_LT(change, 0.01 * contrast);
}

TEST(LowFrequency, PutsBackWhatItTookOutAndWorksOnPartsAsOnTheWhole) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 2, {90, 70}, ttf::SampleType::kU16, rampOf);
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const LowFrequency low(input, 20, progress);
  const Image<std::uint16_t> before = input.frame(1);
  Image<std::uint16_t> even = before;
  low.takeOut(1, {0, 0, 90, 70}, &even.at(0, 0));
  std::vector<std::uint16_t> part = input.block(1, 1, {30, 20, 25, 31});
  low.takeOut(1, {30, 20, 25, 31}, part.data());
  for (int y = 0; y < 31; ++y)
    for (int x = 0; x < 25; ++x) EXPECT_EQ(part[(y * 25 + x) * 3], even.at(30 + x, 20 + y, 0));
  EXPECT_NE(even.texels(), before.texels());
  low.putBack(1, even.view());
  for (std::size_t i = 0; i < before.texels().size(); ++i)
    EXPECT_NEAR(even.texels()[i], before.texels()[i], 2);
}

TEST(LowFrequency, DoesNothingToABlackFrame) {
  const TempFolder folder = TempFolder::inMemory();
  writeTexture(folder / "in.h5", 1, {40, 40}, ttf::SampleType::kU16,
               [](int, int, double) { return 0.0; });
  const ttf::TtfReader input(folder / "in.h5");
  Progress progress;
  const LowFrequency low(input, 10, progress);
  Image<std::uint16_t> frame = input.frame(0);
  low.takeOut(0, {0, 0, 40, 40}, &frame.at(0, 0));
  EXPECT_EQ(frame.texels(), std::vector<std::uint16_t>(40 * 40 * 3, 0));
}

}  // namespace
}  // namespace patina::quilting
