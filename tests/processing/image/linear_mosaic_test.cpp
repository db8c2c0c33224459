// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/linear_mosaic.h"

#include <gtest/gtest.h>

#include <cmath>

#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina {
namespace {

TEST(DemosaicLinear, IsThatOfTheRawFileForEveryOrderOfFiltersAndSize) {
  for (const std::array<std::uint8_t, 4> cfa : {std::array<std::uint8_t, 4>{0, 1, 1, 2},
                                                {2, 1, 1, 0},
                                                {1, 0, 2, 1},
                                                {1, 2, 0, 1},
                                                {0, 0, 1, 2}})
    for (const SizePx size : {SizePx{17, 12}, {2, 2}, {1, 5}, {40, 1}}) {
      RawMosaic raw;
      raw.cfa = cfa;
      raw.black_level = 64;
      raw.white_level = 4095;
      raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
      Image<float> linear(size.width, size.height, 1);
      for (std::size_t i = 0; i < linear.texels().size(); ++i) {
        raw.samples.texels()[i] = static_cast<std::uint16_t>(hashSeed(1, i) % 4096);
        linear.texels()[i] = (static_cast<float>(raw.samples.texels()[i]) - 64) / 4031;
      }
      const Image<float> wanted = demosaic(raw);
      const Image<float> got = demosaicLinear(std::as_const(linear).view(), cfa);
      for (std::size_t i = 0; i < wanted.texels().size(); ++i) {
        // A colour that no filter near the border has is 0 here and black there.
        if (wanted.texels()[i] == 0) continue;
        ASSERT_NEAR(got.texels()[i], wanted.texels()[i], 1e-6) << size.width << " at " << i;
      }
    }
}

// A grey texture finer than the mosaic's colours: what each of them lacks the others have.
TEST(DemosaicDetailed, IsNearerToGreyDetailThanTheMeanOfNeighboursAndKeepsEachPixelsOwn) {
  for (const std::array<std::uint8_t, 4> cfa :
       {std::array<std::uint8_t, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    Image<float> grey(64, 48, 1);
    for (int y = 0; y < 48; ++y)
      for (int x = 0; x < 64; ++x)
        grey.at(x, y) = static_cast<float>(0.5 + 0.2 * std::sin(1.1 * x) * std::cos(0.9 * y));
    const ImageView<const float> mosaic = std::as_const(grey).view();
    const Image<float> plain = demosaicLinear(mosaic, cfa), fine = demosaicDetailed(mosaic, cfa);
    double plain2 = 0, fine2 = 0;
    for (int y = 4; y < 44; ++y)
      for (int x = 4; x < 60; ++x) {
        const int cell = (y & 1) * 2 + (x & 1), own = cfa[static_cast<std::size_t>(cell)];
        ASSERT_EQ(fine.at(x, y, own), grey.at(x, y));
        for (int c = 0; c < 3; ++c) {
          plain2 += std::pow(plain.at(x, y, c) - grey.at(x, y), 2);
          fine2 += std::pow(fine.at(x, y, c) - grey.at(x, y), 2);
        }
      }
    EXPECT_LT(fine2, 0.25 * plain2);
  }
}

// Colours that do not change together: a flat field stays flat, whatever its colour.
TEST(DemosaicDetailed, LeavesFlatColoursFlat) {
  Image<float> mosaic(12, 12, 1);
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x) mosaic.at(x, y) = 0.2f * static_cast<float>(1 + (x & 1) + (y & 1));
  const Image<float> flat = demosaicDetailed(std::as_const(mosaic).view(), {0, 1, 1, 2});
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 12; ++x)
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(flat.at(x, y, c), 0.2f * static_cast<float>(1 + c), 1e-6f);
}

}  // namespace
}  // namespace patina
