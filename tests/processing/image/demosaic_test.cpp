// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "processing/image/dng_file.h"
#include "tests/processing/image/samples.h"
#include "tests/support/matchers.h"

namespace patina {
namespace {

using testing::ImageNear;

// Samples of a plane of one colour ramp per channel, exact under bilinear interpolation.
RawMosaic rampMosaic(const std::array<std::uint8_t, 4>& cfa) {
  RawMosaic raw;
  raw.cfa = cfa;
  raw.black_level = 100;
  raw.white_level = 4100;
  raw.samples = Image<std::uint16_t>(30, 22, 1);
  for (int y = 0; y < 22; ++y)
    for (int x = 0; x < 30; ++x) {
      const int colour = cfa[(y % 2) * 2 + x % 2];
      raw.samples.at(x, y) = static_cast<std::uint16_t>(100 + 1000 * colour + 20 * x + 8 * y);
    }
  return raw;
}

TEST(Demosaic, IsExactOnRampsForEveryFilterOrder) {
  for (const std::array<std::uint8_t, 4> cfa :
       {std::array<std::uint8_t, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    const auto out = demosaic(rampMosaic(cfa));
    for (int y = 1; y < 21; ++y)
      for (int x = 1; x < 29; ++x)
        for (int c = 0; c < 3; ++c)
          ASSERT_NEAR(out.at(x, y, c), (1000 * c + 20 * x + 8 * y) / 4000.0, 1e-5) << x << "," << y;
  }
}

TEST(Demosaic, OfAFlatFieldIsFlatToTheLastPixelOfTheBorder) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(7, 5, 1, 2100);
  raw.black_level = 100;
  raw.white_level = 4100;
  EXPECT_THAT(demosaic(raw), ImageNear(Image<float>(7, 5, 3, 0.5f), 1e-6));
  EXPECT_THAT(demosaicHalf(raw), ImageNear(Image<float>(3, 2, 3, 0.5f), 1e-6));
}

TEST(Demosaic, KeepsNoiseBelowBlackNegative) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(4, 4, 1, 50);
  raw.black_level = 100;
  raw.white_level = 1100;
  EXPECT_NEAR(demosaic(raw).at(1, 1, 0), -0.05f, 1e-6);
  raw.white_level = 100;
  EXPECT_THROW(demosaic(raw), ProcessingError);
}

TEST(DemosaicHalf, AveragesTheTwoGreens) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(2, 2, 1);
  raw.samples.texels() = {100, 200, 400, 800};
  raw.black_level = 0;
  raw.white_level = 1000;
  const auto out = demosaicHalf(raw);
  EXPECT_NEAR(out.at(0, 0, 0), 0.1f, 1e-6);
  EXPECT_NEAR(out.at(0, 0, 1), 0.3f, 1e-6);
  EXPECT_NEAR(out.at(0, 0, 2), 0.8f, 1e-6);
}

TEST(Demosaic, IsTheSameOnOneThread) {
  const RawMosaic raw = mosaic(512, 400);
  const auto many = demosaic(raw);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(demosaic(raw).texels(), many.texels());
}

}  // namespace
}  // namespace patina
