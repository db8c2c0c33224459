// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/mosaic_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>

#include "processing/image/linear_mosaic.h"
#include "processing/image/random.h"

namespace patina::calibration {
namespace {

constexpr int kSide = 128, kSpecks = 12;
constexpr double kSpeck_px = 0.7, kNoise = 0.03;

// Round red specks on grey, of which green shows a quarter, through a mosaic with noise.
PreparedPicture specks(PlacePx by, std::uint64_t seed) {
  Image<float> mosaic(kSide, kSide, 1);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      double red = 0;
      for (std::uint64_t k = 0; k < kSpecks; ++k) {
        const double u = x - by.x - 10 - 108 * uniform(hashSeed(1, k)),
                     v = y - by.y - 10 - 108 * uniform(hashSeed(2, k));
        red += 4 * std::exp(-0.5 * (u * u + v * v) / (kSpeck_px * kSpeck_px));
      }
      constexpr std::array<double, 3> kShare{1, 0.25, 0};
      const auto key = static_cast<std::uint64_t>(y * kSide + x);
      // Uniform, of the same variance as a normal one of kNoise.
      const double noise = kNoise * std::sqrt(12.0) * (uniform(hashSeed(seed, key)) - 0.5);
      mosaic.at(x, y) = static_cast<float>(
          0.1 * (1 + kShare[static_cast<std::size_t>((x & 1) + (y & 1))] * red + noise));
    }
  return preparePicture(demosaicLinear(std::as_const(mosaic).view(), {0, 1, 1, 2}).view());
}

TEST(MosaicRefinement, PlacesAFewRedSpecksFinerThanTheMosaic) {
  double squares = 0, expected = 0;
  constexpr int kPairs = 12;
  for (std::uint64_t k = 0; k < kPairs; ++k) {
    const PlacePx by{4 * uniform(hashSeed(3, k)) - 2, 4 * uniform(hashSeed(4, k)) - 2};
    const PreparedPicture reference = specks({}, 100 + k), frame = specks(by, 200 + k);
    const Motion start = shift(by.x + 0.3, by.y - 0.2);
    const MosaicShift found =
        refineByPhotosites(reference, frame, start, agreementOf(reference, frame, start));
    squares += std::pow(found.frame_from_reference[2] - by.x, 2) +
               std::pow(found.frame_from_reference[5] - by.y, 2);
    expected += found.uncertainty_px * found.uncertainty_px;
  }
  const double off_px = std::sqrt(squares / kPairs), expected_px = std::sqrt(expected / kPairs);
  std::printf("%d red specks: off by %.4f px RMS, expected %.4f px\n", kSpecks, off_px,
              expected_px);
  EXPECT_LE(off_px, 0.05);
  EXPECT_LE(off_px, 2 * expected_px);
  EXPECT_GE(off_px, expected_px / 2);
}

TEST(MosaicRefinement, FindsNothingWhereNothingStandsOutOrNoMosaicShows) {
  const PreparedPicture seen = specks({}, 1);
  const Agreement agreement = agreementOf(seen, seen, kNoMotion);
  const auto expectNothing = [&](const PreparedPicture& reference, const PreparedPicture& frame) {
    const MosaicShift found = refineByPhotosites(reference, frame, shift(0.3, 0), agreement);
    EXPECT_TRUE(std::isinf(found.uncertainty_px));
    EXPECT_EQ(found.frame_from_reference, shift(0.3, 0));
  };
  expectNothing(specks({1000, 0}, 2), specks({1000, 0}, 3));
  PreparedPicture resampled = seen;
  resampled.photosites = {};
  expectNothing(resampled, seen);
}

}  // namespace
}  // namespace patina::calibration
