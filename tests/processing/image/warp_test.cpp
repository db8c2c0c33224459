// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/warp.h"

#include <gmock/gmock.h>

#include "processing/image/random.h"
#include "tests/processing/image/samples.h"
#include "tests/support/matchers.h"

namespace patina {
namespace {

using testing::ImageNear;

Image<float> noise(int width, int height) {
  Image<float> out(width, height, 3);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(uniform(hashSeed(1, i)));
  return out;
}

TEST(ResizeArea, OfAWholeNumberIsTheMeanOfEachBlock) {
  const auto in = noise(12, 9);
  const auto out = resizeArea(in.view(), {4, 3});
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x) {
      float sum = 0;
      for (int j = 0; j < 9; ++j) sum += in.at(3 * x + j % 3, 3 * y + j / 3, 1);
      EXPECT_NEAR(out.at(x, y, 1), sum / 9, 1e-6);
    }
}

TEST(ResizeArea, KeepsAConstantAtAnySize) {
  const Image<float> in(17, 13, 2, 0.25f);
  for (const SizePx size :
       {SizePx{5, 4}, SizePx{17, 13}, SizePx{40, 31}, SizePx{1, 1}, SizePx{16, 50}})
    EXPECT_THAT(resizeArea(in.view(), size),
                ImageNear(Image<float>(size.width, size.height, 2, 0.25f), 1e-6));
  EXPECT_EQ(resizeArea(Image<float>(1, 1, 1, 3.0f).view(), {4, 4}).at(3, 3), 3.0f);
}

TEST(ResizeArea, KeepsTheMeanOfAnUnevenShrink) {
  const auto in = noise(100, 70);
  const auto out = resizeArea(in.view(), {33, 19});
  double before = 0, after = 0;
  for (float v : in.texels()) before += v / static_cast<double>(in.texels().size());
  for (float v : out.texels()) after += v / static_cast<double>(out.texels().size());
  EXPECT_NEAR(before, after, 1e-4);
}

TEST(ResizeSrgb, MixesLightAndNotCodes) {
  Image<std::uint8_t> checker(2, 1, 1);
  checker.at(1, 0) = 255;
  EXPECT_EQ(resizeSrgb(checker.view(), {1, 1}).at(0, 0), 188);  // half the light
}

TEST(FitInside, KeepsTheShape) {
  EXPECT_EQ(fitInside({300, 480}, {150, 1000}), (SizePx{150, 240}));
  EXPECT_EQ(fitInside({300, 480}, {1000, 48}), (SizePx{30, 48}));
  EXPECT_EQ(fitInside({1000, 1}, {10, 10}), (SizePx{10, 1}));
}

TEST(WarpBilinear, ByTheIdentityAndByAShiftIsExact) {
  const auto in = noise(20, 10);
  EXPECT_THAT(warpBilinear(in.view(), {1, 0, 0, 0, 1, 0, 0, 0, 1}, in.size()), ImageNear(in, 0));
  const auto shifted = warpBilinear(in.view(), {1, 0, 2, 0, 1, 1, 0, 0, 1}, in.size(), -1);
  EXPECT_EQ(shifted.at(3, 4, 0), in.at(5, 5, 0));
  EXPECT_EQ(shifted.at(19, 4, 0), -1);
}

TEST(WarpBilinear, IsExactOnARampUnderAProjectiveMap) {
  Image<float> ramp(50, 40, 1);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) ramp.at(x, y) = static_cast<float>(2 * x + 3 * y);
  const std::array<double, 9> map{0.8, 0.1, 2, -0.05, 0.9, 3, 0.001, 0.002, 1};
  const auto out = warpBilinear(ramp.view(), map, {30, 30});
  for (int i = 0; i < 30; ++i) {
    const double w = 0.001 * i + 0.002 * i + 1;
    EXPECT_NEAR(out.at(i, i), (2 * (0.9 * i + 2) + 3 * (0.85 * i + 3)) / w, 1e-3);
  }
}

}  // namespace
}  // namespace patina
