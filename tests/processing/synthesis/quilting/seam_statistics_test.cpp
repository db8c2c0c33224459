// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/synthesis/quilting/seam_statistics.h"

#include <gtest/gtest.h>

#include <array>

namespace patina::quilting {
namespace {

// Two columns-wise pieces of a ramp: texels 0..3 and then from `second` on.
Quilt twoPieces(int second) {
  Quilt q{Image<std::int32_t>(8, 2, 2), Image<std::int32_t>(8, 2, 1)};
  for (int y = 0; y < 2; ++y)
    for (int x = 0; x < 8; ++x) {
      q.source_xy.at(x, y, 0) = x < 4 ? x : second + x - 4;
      q.source_xy.at(x, y, 1) = y;
    }
  return q;
}

Image<float> ramp(int width) {
  Image<float> f(width, 2, 1);
  for (int x = 0; x < width; ++x) f.at(x, 0) = f.at(x, 1) = static_cast<float>(x);
  return f;
}

double ratioOf(const Image<float>& source, const Quilt& quilt) {
  return seamRatio(applyQuilt(source.view(), quilt).view(), quilt);
}

TEST(SeamRatio, IsTheStepAcrossTheSeamOverTheMeanStepInside) {
  // Inside: 12 steps of 1 along rows, 8 of 0 along columns; the seam's two steps are 7.
  EXPECT_DOUBLE_EQ(ratioOf(ramp(20), twoPieces(10)), 7.0 / (12.0 / 20.0));
}

TEST(SeamRatio, IsZeroWhereThereIsNoSeamOrNoGradient) {
  EXPECT_EQ(ratioOf(ramp(20), twoPieces(4)), 0);
  EXPECT_EQ(ratioOf(Image<float>(20, 2, 1), twoPieces(10)), 0);
}

TEST(SeamRatio, InPlaceIsAgainstWhatTheSourcesShowAtTheSeam) {
  Image<float> source = ramp(20);
  for (int y = 0; y < 2; ++y) source.at(4, y) = 9;  // from 3: a step of 6
  for (int y = 0; y < 2; ++y) source.at(9, y) = 7;  // to 10: a step of 3
  const Quilt quilt = twoPieces(10);
  const Image<float> result = applyQuilt(source.view(), quilt);
  const ImageView<const float> view = source.view();
  // From 3 to 10: 7, where one source goes on by 6 and the other comes by 3.
  EXPECT_DOUBLE_EQ(seamRatioInPlace(result.view(), quilt, {&view, 1}), 7 / 4.5);
}

TEST(SeamRatio, InPlaceTakesOneSideWhereTheOtherSourceEnds) {
  const Image<float> source = ramp(4);
  Quilt quilt{Image<std::int32_t>(2, 1, 2), Image<std::int32_t>(2, 1, 1)};
  quilt.source_xy.at(0, 0, 0) = 3;  // the last column: nothing goes on there
  quilt.source_xy.at(1, 0, 0) = 1;
  quilt.block.at(1, 0) = 1;
  const Image<float> result = applyQuilt(source.view(), quilt);
  const std::array<ImageView<const float>, 2> of_block{source.view(), source.view()};
  EXPECT_DOUBLE_EQ(seamRatioInPlace(result.view(), quilt, of_block), 2);
}

TEST(SeamSelection, IsTheGradientAtSeamsOverThatInside) {
  Image<float> source = ramp(20);
  for (int y = 0; y < 2; ++y) source.at(4, y) = 9;
  for (int y = 0; y < 2; ++y) source.at(9, y) = 7;
  // Inside as above: 12 steps of 1 along rows, 8 of 0.
  EXPECT_DOUBLE_EQ(seamSelection(source.view(), twoPieces(10)), 4.5 / (12.0 / 20.0));
}

// Strokes along rows, each of a brightness of its own; of two pieces beside one another the right
// one is a little brighter.
TEST(SeamRatio, OfAreasFindsAStepThatFineDetailHides) {
  constexpr int kSide = 40;
  Quilt quilt{Image<std::int32_t>(kSide, kSide, 2), Image<std::int32_t>(kSide, kSide, 1)};
  Image<float> shown(kSide, kSide, 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      quilt.source_xy.at(x, y, 0) = x < kSide / 2 ? x : x + 100;
      quilt.source_xy.at(x, y, 1) = y;
      shown.at(x, y) = static_cast<float>(y % 2) + 0.02f * static_cast<float>(x % 2) +
                       (x < kSide / 2 ? 0.0f : 0.4f);
    }
  EXPECT_LT(seamRatio(shown.view(), quilt), 1.1);
  EXPECT_GT(seamRatioOfAreas(shown.view(), quilt, 4), 2);
}

}  // namespace
}  // namespace patina::quilting
