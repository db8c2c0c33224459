// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/brdf/picture_score.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/random.h"

namespace patina::brdf {
namespace {

Image<float> noise(std::uint64_t seed, float mean, float spread) {
  Image<float> out(40, 30, 3);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = mean + spread * static_cast<float>(uniform(hashSeed(seed, i)) - 0.5);
  return out;
}

TEST(PictureScore, PsnrOfATenthIsTwentyDb) {
  const Image<float> a(20, 20, 1, 0.3f), b(20, 20, 1, 0.4f);
  EXPECT_NEAR(psnrDb(meanSquareError(a.view(), b.view())), 20, 1e-4);
  EXPECT_TRUE(std::isinf(psnrDb(meanSquareError(a.view(), a.view()))));
}

TEST(PictureScore, ValuesBeyondTheScaleCountAsItsEnds) {
  const Image<float> a(4, 4, 1, 1.0f), b(4, 4, 1, 3.0f);
  EXPECT_EQ(meanSquareError(a.view(), b.view()), 0);
}

TEST(PictureScore, SsimIsOneOfEqualsAndNearNoneOfUnrelatedNoise) {
  const Image<float> a = noise(1, 0.5f, 0.6f), b = noise(2, 0.5f, 0.6f);
  EXPECT_NEAR(ssim(a.view(), a.view()), 1, 1e-9);
  EXPECT_LT(std::abs(ssim(a.view(), b.view())), 0.15);
}

// Of constants the structure term is 1 and (2ab + C1) / (a^2 + b^2 + C1) is left.
TEST(PictureScore, SsimOfConstantsIsTheirLuminanceTerm) {
  const Image<float> a(20, 20, 1, 0.2f), b(20, 20, 1, 0.4f);
  EXPECT_NEAR(ssim(a.view(), b.view()), (2 * 0.08 + 1e-4) / (0.2 + 1e-4), 1e-5);
}

}  // namespace
}  // namespace patina::brdf
