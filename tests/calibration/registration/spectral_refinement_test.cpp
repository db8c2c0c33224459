// SPDX-License-Identifier: GPL-3.0-or-later
#include "calibration/registration/spectral_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "processing/image/random.h"

namespace patina::calibration {
namespace {

constexpr int kSidePx = 384;
constexpr double kNoise = 0.02, kBlob = 0.018, kBlobsAPixel = 0.008, kRadius_px = 3;

double normal(std::uint64_t key) {
  return std::sqrt(-2 * std::log(1 - uniform(hashSeed(key, 1)))) *
         std::cos(2 * std::numbers::pi * uniform(hashSeed(key, 2)));
}

// Soft blobs strewn at random, lighter and darker, moved by `by`: a texture whose spectrum is
// known. White noise of its own for every `seed`.
Image<float> softBlobs(std::uint64_t texture, PlacePx by, std::uint64_t seed) {
  constexpr int kMarginPx = 16, kReachPx = 12;
  constexpr int kAcross = kSidePx + 2 * kMarginPx;
  Image<float> out(kSidePx, kSidePx, 1, 1.0f);
  const auto count = static_cast<std::uint64_t>(kBlobsAPixel * kAcross * kAcross);
  for (std::uint64_t k = 0; k < count; ++k) {
    const std::uint64_t key = hashSeed(texture, k);
    const double x = kAcross * uniform(hashSeed(key, 3)) - kMarginPx + by.x,
                 y = kAcross * uniform(hashSeed(key, 4)) - kMarginPx + by.y;
    const double lighter = kBlob * normal(key);
    for (int py = std::max(0, static_cast<int>(y) - kReachPx);
         py < std::min(kSidePx, static_cast<int>(y) + kReachPx); ++py)
      for (int px = std::max(0, static_cast<int>(x) - kReachPx);
           px < std::min(kSidePx, static_cast<int>(x) + kReachPx); ++px)
        out.at(px, py) +=
            static_cast<float>(lighter * std::exp(-((px - x) * (px - x) + (py - y) * (py - y)) /
                                                  (2 * kRadius_px * kRadius_px)));
  }
  for (std::size_t k = 0; k < out.texels().size(); ++k)
    out.texels()[k] += static_cast<float>(kNoise * normal(hashSeed(seed, 9, k)));
  return out;
}

// Cramer and Rao's bound of a shift of that texture, both pictures noisy, sqrt(x^2 + y^2): the
// information of a frequency is (2 pi f)^2 C^2 / (1 - C^2), C = signal over signal and noise.
double boundPx() {
  const double blob = 2 * std::numbers::pi * kRadius_px * kRadius_px;
  double information = 0;  // of x
  constexpr double kStep = 1.0 / 512;
  for (double fy = -0.5; fy < 0.5; fy += kStep)
    for (double fx = -0.5; fx < 0.5; fx += kStep) {
      const double w2 = 4 * std::numbers::pi * std::numbers::pi * (fx * fx + fy * fy);
      const double signal =
          kBlobsAPixel * kBlob * kBlob * blob * blob * std::exp(-w2 * kRadius_px * kRadius_px);
      const double coherence = signal / (signal + kNoise * kNoise);
      information += 0.5 * w2 * coherence * coherence / (1 - coherence * coherence);
    }
  const double pixels = static_cast<double>(kSidePx) * kSidePx;
  return std::sqrt(2 / (information * kStep * kStep * pixels));
}

TEST(SpectralRefinement, ComesWithinATenthOfTheCramerRaoBoundOnANearlyBlankSurface) {
  double squares = 0, expected = 0;
  constexpr int kPairs = 60;
  for (std::uint64_t k = 0; k < kPairs; ++k) {
    const PlacePx by{2 * uniform(hashSeed(11, k)) - 1, 2 * uniform(hashSeed(12, k)) - 1};
    const PreparedPicture reference = preparePicture(softBlobs(k, {}, 2 * k).view()),
                          frame = preparePicture(softBlobs(k, by, 2 * k + 1).view());
    const Motion start = shift(by.x + 0.3, by.y - 0.2);
    const SpectralShift found =
        refineBySpectrum(reference, frame, start, agreementOf(reference, frame, start));
    const Motion& m = found.frame_from_reference;
    squares += (m[2] - by.x) * (m[2] - by.x) + (m[5] - by.y) * (m[5] - by.y);
    expected += found.uncertainty_px * found.uncertainty_px;
  }
  const double rms = std::sqrt(squares / kPairs), bound = boundPx();
  std::printf("soft blobs: %.4f px RMS, bound %.4f px, expected of itself %.4f px\n", rms, bound,
              std::sqrt(expected / kPairs));
  EXPECT_LE(rms, 1.1 * bound);
  EXPECT_NEAR(std::sqrt(expected / kPairs), rms, 0.2 * rms);
}

}  // namespace
}  // namespace patina::calibration
