// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <tbb/global_control.h>

#include "processing/image/dng_file.h"
#include "processing/image/encoding.h"
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

// The definition: the mean of the samples of a colour in the 3x3 window, or the sample itself.
float meanAround(const RawMosaic& raw, int x, int y, int colour) {
  const auto colourAt = [&](int u, int v) { return raw.cfa[(v & 1) * 2 + (u & 1)]; };
  const int reach = colourAt(x, y) == colour ? 0 : 1;
  int sum = 0, count = 0;
  for (int v = std::max(0, y - reach); v <= std::min(raw.samples.height() - 1, y + reach); ++v)
    for (int u = std::max(0, x - reach); u <= std::min(raw.samples.width() - 1, x + reach); ++u)
      if (colourAt(u, v) == colour) {
        sum += raw.samples.at(u, v);
        ++count;
      }
  if (count == 0) return 0;
  const auto range = static_cast<float>(1.0 / (raw.white_level - raw.black_level));
  return (static_cast<float>(sum) / static_cast<float>(count) -
          static_cast<float>(raw.black_level)) *
         range;
}

TEST(Demosaic, IsItsDefinitionToTheBitForEverySizeAndFilter) {
  for (const std::array<std::uint8_t, 4> cfa : {std::array<std::uint8_t, 4>{0, 1, 1, 2},
                                                {2, 1, 1, 0},
                                                {1, 0, 2, 1},
                                                {1, 2, 0, 1},
                                                {0, 1, 2, 1},
                                                {1, 1, 1, 1},
                                                {0, 1, 1, 0}})
    for (const SizePx size : {SizePx{1, 1}, {2, 3}, {3, 3}, {4, 2}, {7, 6}, {64, 48}}) {
      RawMosaic raw = mosaic(size.width, size.height);
      raw.cfa = cfa;
      const auto out = demosaic(raw);
      for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x)
          for (int c = 0; c < 3; ++c)
            ASSERT_EQ(out.at(x, y, c), meanAround(raw, x, y, c)) << x << "," << y << "," << c;
    }
}

TEST(SrgbDeveloper, GivesTheBytesOfTheDemosaicedPicture) {
  for (const SizePx size : {SizePx{1, 1}, {3, 3}, {64, 48}, {65, 47}}) {
    RawMosaic raw = mosaic(size.width, size.height);
    raw.samples.at(0, 0) = 0;                                  // below black
    raw.samples.at(size.width / 2, size.height / 2) = 65'535;  // far above white
    const SrgbDeveloper develop(raw.black_level, raw.white_level);
    EXPECT_EQ(develop(raw).texels(), encodeSrgb8(demosaic(raw).view()).texels());
  }
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
