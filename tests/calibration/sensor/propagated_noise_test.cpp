// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/sensor/propagated_noise.h"

#include <gtest/gtest.h>

#include <utility>

namespace patina::calibration {
namespace {

// Mean of a pixel and its right neighbour.
Image<float> halfAndHalf(ImageView<const float> in) {
  Image<float> out(in.width, in.height, 1);
  for (int y = 0; y < in.height; ++y)
    for (int x = 0; x < in.width; ++x)
      out.at(x, y) = 0.5f * (in.at(x, y) + in.at(std::min(x + 1, in.width - 1), y));
  return out;
}
double meanOf(const Image<float>& image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x + 3 < image.width(); ++x) sum += image.at(x, y);
  return sum / (image.height() * (image.width() - 3));
}

TEST(VarianceThrough, KnowsThatNeighboursOfOneStepAreNotIndependentInTheNext) {
  const Image<float> light(64, 64, 1, 0.5f), variance(64, 64, 1, 4e-6f);
  const auto through = [&](const LightSteps& steps) {
    return meanOf(varianceThrough(steps, light.view(), variance.view(), {.probes = 100})) / 4e-6;
  };
  EXPECT_NEAR(through(halfAndHalf), 0.5, 0.01);
  // 1/4, 1/2, 1/4: six sixteenths, not a quarter.
  EXPECT_NEAR(through([](ImageView<const float> in) {
                const Image<float> once = halfAndHalf(in);
                return halfAndHalf(once.view());
              }),
              0.375, 0.01);
}

TEST(VarianceThrough, IsEachPixelsOwnAndTheSameEveryTime) {
  const Image<float> light(32, 32, 1, 0.5f);
  Image<float> variance(32, 32, 1, 0);
  variance.at(7, 9) = 1e-4f;
  const LightSteps same = [](ImageView<const float> in) { return copyOf<float>(in); };
  const Image<float> one = varianceThrough(same, light.view(), std::as_const(variance).view(),
                                           {.probes = 1000}),
                     two = varianceThrough(same, light.view(), std::as_const(variance).view(),
                                           {.probes = 1000});
  EXPECT_NEAR(one.at(7, 9), 1e-4, 2e-5);
  EXPECT_EQ(one.at(8, 9), 0);
  EXPECT_EQ(one.texels(), two.texels());
}

TEST(VarianceThrough, RefusesTooFewProbesAndUnequalSizes) {
  const Image<float> light(8, 8, 1, 0.5f), small(4, 8, 1, 1e-4f);
  EXPECT_THROW(varianceThrough(halfAndHalf, light.view(), light.view(), {.probes = 1}),
               CalibrationError);
  EXPECT_THROW(varianceThrough(halfAndHalf, light.view(), small.view()), CalibrationError);
}

}  // namespace
}  // namespace patina::calibration
