// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

TEST(Spectra, RoundsSidesUpToLengthsOfSmallPrimes) {
  EXPECT_EQ(Spectra({11, 13}).padded(), (SizePx{16, 14}));
  EXPECT_EQ(Spectra({1, 450}).padded(), (SizePx{16, 450}));
  EXPECT_EQ(Spectra({479, 127}).padded(), (SizePx{480, 128}));
}

TEST(Spectra, ComesBackToThePlaneItCameFrom) {
  const Spectra spectra({30, 17});
  const int width = spectra.padded().width, height = spectra.padded().height;
  Spectra::Plane plane(static_cast<std::size_t>(width) * height), back;
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = static_cast<float>(uniform(hashSeed(3, i)));
  Spectra::Spectrum bins;
  spectra.forward(
      height, [&](float* p) { std::copy(plane.begin(), plane.end(), p); }, bins);
  double sum = 0;
  for (float v : plane) sum += v;
  EXPECT_NEAR(bins[0].real(), sum, 1e-3);
  EXPECT_EQ(bins.size(), static_cast<std::size_t>(spectra.pitch()) * height);
  spectra.inverse(bins, back);
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_NEAR(back[i], plane[i], 1e-6);
}

TEST(Spectra, StartsEachPlaneFromZero) {
  const Spectra spectra({8, 8});
  Spectra::Spectrum bins;
  spectra.forward(
      8, [](float* p) { std::fill_n(p, 128, 1.0f); }, bins);
  spectra.forward(
      8, [](float*) {}, bins);
  for (const auto& v : bins) EXPECT_EQ(std::abs(v), 0);
}

}  // namespace
}  // namespace patina::patch
