// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/mosaic_blur.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cmath>
#include <numeric>

#include "processing/image/random.h"

namespace patina::devices::twin {
namespace {

constexpr SizePx kSize{256, 192};
constexpr std::size_t kPixels = 256 * 192;

std::vector<float> noise() {
  std::vector<float> light(kPixels);
  for (std::size_t k = 0; k < kPixels; ++k) light[k] = static_cast<float>(uniform(k));
  return light;
}

TEST(MosaicBlur, KeepsOfASineWhatAGaussianKeeps) {
  for (const double sigma : {1.5, 3.0, 6.0})
    for (const int cycles : {4, 8, 16}) {
      const double f = cycles / 256.0;
      std::vector<float> light(kPixels);
      for (std::size_t k = 0; k < kPixels; ++k)
        light[k] = static_cast<float>(1 + std::sin(2 * M_PI * f * static_cast<double>(k % 256)));
      blurMosaic(light, kSize, sigma);
      double amplitude = 0;
      for (int x = 64; x < 192; ++x)
        amplitude +=
            (light[96 * 256 + static_cast<std::size_t>(x)] - 1) * std::sin(2 * M_PI * f * x) / 64;
      EXPECT_NEAR(amplitude, std::exp(-2 * M_PI * M_PI * sigma * sigma * f * f), 2e-3)
          << sigma << " " << cycles;
    }
}

TEST(MosaicBlur, LeavesTheMiddleOfAllLightAndNoColourLeaks) {
  std::vector<float> light(kPixels);
  for (std::size_t k = 0; k < kPixels; ++k)
    light[k] = static_cast<float>((k % 2) + 2 * (k / 256 % 2) + 1);
  const std::vector<float> before = light;
  blurMosaic(light, kSize, 9);
  for (std::size_t k = 0; k < kPixels; ++k) ASSERT_NEAR(light[k], before[k], 1e-5) << k;
}

TEST(MosaicBlur, IsTheSameForAnyNumberOfThreads) {
  std::vector<float> one = noise(), many = noise();
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    fogMosaic(one, kSize, 0.4);
  }
  fogMosaic(many, kSize, 0.4);
  EXPECT_EQ(one, many);
}

TEST(MosaicBlur, FogTakesItsShareOfContrastAndLeavesTheMean) {
  std::vector<float> light(kPixels);
  for (std::size_t k = 0; k < kPixels; ++k) light[k] = k % 256 < 128 ? 1.0f : 3.0f;
  fogMosaic(light, kSize, 0.3);
  EXPECT_NEAR(light[96 * 256 + 200] - light[96 * 256 + 20], 2 * 0.7, 1e-4);
  EXPECT_NEAR(std::accumulate(light.begin(), light.end(), 0.0) / kPixels, 2, 1e-4);
}

}  // namespace
}  // namespace patina::devices::twin
