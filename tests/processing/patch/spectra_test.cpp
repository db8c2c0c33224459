// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/spectra.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

TEST(Spectra, RoundsSidesUpToLengthsOfSmallPrimes) {
  EXPECT_EQ(Spectra({11, 13}).padded(), (SizePx{16, 16}));
  EXPECT_EQ(Spectra({1, 450}).padded(), (SizePx{16, 480}));
  EXPECT_EQ(Spectra({479, 127}).padded(), (SizePx{480, 128}));
}

TEST(Spectra, ComesBackToThePlaneItCameFrom) {
  const Spectra spectra({30, 17});
  const int width = spectra.padded().width, height = spectra.padded().height;
  Spectra::Plane plane(static_cast<std::size_t>(width) * height), back;
  for (std::size_t i = 0; i < plane.size(); ++i)
    plane[i] = static_cast<float>(uniform(hashSeed(3, i)));
  Spectra::Spectrum bins;
  spectra.forward(plane, bins);
  double sum = 0;
  for (float v : plane) sum += v;
  EXPECT_NEAR(bins[0].real(), sum, 1e-3);
  EXPECT_EQ(bins.size(), static_cast<std::size_t>(spectra.columns()) * height);
  spectra.inverse(bins, back);
  for (std::size_t i = 0; i < plane.size(); ++i) EXPECT_NEAR(back[i], plane[i], 1e-6);
}

TEST(Spectra, TakesRowsThatAreNotGivenForZero) {
  const Spectra spectra({8, 8});
  const std::size_t width = spectra.padded().width;
  Spectra::Plane plane(width * 8), first(width * 3);
  for (std::size_t i = 0; i < first.size(); ++i)
    first[i] = plane[i] = static_cast<float>(uniform(hashSeed(3, i)));
  Spectra::Spectrum whole, part;
  spectra.forward(plane, whole);
  spectra.forward(first, part);
  EXPECT_EQ(whole, part);
}

TEST(Spectra, CorrelatesAsTheSumsSay) {
  const Spectra spectra({40, 30});
  const SizePx size = spectra.padded();
  constexpr int kPlanes = 3, kRows = 5, kRowsOut = 21;
  std::vector<Spectra::Plane> source, target;
  std::vector<Spectra::Spectrum> bins(kPlanes);
  for (int k = 0; k < kPlanes; ++k) {
    source.emplace_back(static_cast<std::size_t>(size.width) * size.height);
    target.emplace_back(static_cast<std::size_t>(size.width) * kRows);
    for (std::size_t i = 0; i < source[k].size(); ++i)
      source[k][i] = static_cast<float>(gaussian(hashSeed(1, k, i)));
    for (int i = 0; i < kRows * size.width; ++i)
      if (i % size.width < 7) target[k][i] = static_cast<float>(gaussian(hashSeed(2, k, i)));
    spectra.forward(source[k], bins[k]);
  }
  std::vector<std::vector<float>> found(kRowsOut);
  Spectra::Room room;
  spectra.correlate(target, bins, -2, kRowsOut, room,
                    [&](int y, const float* row) { found[y].assign(row, row + size.width); });
  for (int y = 0; y < kRowsOut; ++y)
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int k = 0; k < kPlanes; ++k)
        for (int j = 0; j < kRows; ++j)
          for (int i = 0; i < 7; ++i)
            sum += double{target[k][j * size.width + i]} *
                   source[k][(y + j) % size.height * size.width + (x + i) % size.width];
      ASSERT_NEAR(found[y][x], -2 * sum, 2e-4) << x << "," << y;
    }
}

}  // namespace
}  // namespace patina::patch
