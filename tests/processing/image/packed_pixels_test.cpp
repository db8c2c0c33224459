// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/packed_pixels.h"

#include <gmock/gmock.h>

#include <vector>

namespace patina {
namespace {

using ::testing::ElementsAre;

std::vector<std::byte> bytes(std::initializer_list<int> values) {
  std::vector<std::byte> out;
  for (const int v : values) out.push_back(static_cast<std::byte>(v));
  return out;
}

std::vector<std::uint16_t> samples(PixelLayout layout, int bits, int width,
                                   std::initializer_list<int> values) {
  const auto data = bytes(values);
  return unpackSamples({data, {width, 1}, layout, bits}).texels();
}

std::vector<std::uint8_t> rgb(PixelLayout layout, SizePx size, std::initializer_list<int> values,
                              const YuvCoding& coding = kBt601) {
  const auto data = bytes(values);
  return unpackRgb({data, size, layout}, coding).texels();
}

TEST(PackedPixels, WordsLoseWhatLiesAboveTheirBits) {
  EXPECT_THAT(samples(PixelLayout::kLittle16, 10, 2, {0x34, 0xF1, 0xFF, 0x03}),
              ElementsAre(0x134, 0x3FF));
  EXPECT_THAT(samples(PixelLayout::kBig16, 16, 2, {0x12, 0x34, 0xFF, 0xFE}),
              ElementsAre(0x1234, 0xFFFE));
}

// The packings as the kernel's documents draw them.
TEST(PackedPixels, MipiPackingsKeepTheLowBitsLast) {
  EXPECT_THAT(samples(PixelLayout::kMipi, 10, 4, {0x80, 0x00, 0xFF, 0x01, 0b11'10'01'00}),
              ElementsAre(0x200, 0x001, 0x3FE, 0x007));
  EXPECT_THAT(samples(PixelLayout::kMipi, 12, 2, {0xAB, 0x12, 0x3C}), ElementsAre(0xABC, 0x123));
  // Low bits 0x01, 0x3F, 0x00, 0x2A: six a sample, from the lowest bit of 24 upwards.
  EXPECT_THAT(samples(PixelLayout::kMipi, 14, 4, {0x01, 0x02, 0x03, 0x04, 0xC1, 0x0F, 0xA8}),
              ElementsAre(0x41, 0xBF, 0xC0, 0x12A));
}

TEST(PackedPixels, ARowThatEndsWithinAGroupIsWhole) {
  EXPECT_EQ(leastRowBytes(PixelLayout::kMipi, 10, 6), 10u);
  EXPECT_THAT(samples(PixelLayout::kMipi, 12, 1, {0xAB, 0x00, 0x0C}), ElementsAre(0xABC));
}

TEST(PackedPixels, BitStreamsRunFromTheHighBit) {
  // 1111111111 0000000001 1000000000 0000000011
  EXPECT_THAT(samples(PixelLayout::kBitStream, 10, 4, {0xFF, 0xC0, 0x18, 0x00, 0x03}),
              ElementsAre(0x3FF, 0x001, 0x200, 0x003));
}

TEST(PackedPixels, RowsMayBePaddedExceptTheLast) {
  const auto data = bytes({1, 2, 99, 99, 3, 4});
  PackedPixels packed{data, {2, 2}, PixelLayout::kByte, 8, 4};
  EXPECT_THAT(unpackSamples(packed).texels(), ElementsAre(1, 2, 3, 4));
  packed.size.height = 3;
  EXPECT_THROW(unpackSamples(packed), ProcessingError);
}

TEST(PackedPixels, LimitedRangeYuvSpansBlackToWhite) {
  EXPECT_THAT(rgb(PixelLayout::kYuyv, {2, 1}, {16, 128, 235, 128}),
              ElementsAre(0, 0, 0, 255, 255, 255));
  YuvCoding full = kBt601;
  full.full_range = true;
  EXPECT_THAT(rgb(PixelLayout::kYuyv, {2, 1}, {16, 128, 255, 128}, full),
              ElementsAre(16, 16, 16, 255, 255, 255));
}

// BT.601 in limited range: pure red is Y 81, Cb 90, Cr 240.
TEST(PackedPixels, TheFourOrdersOf422GiveTheSameRed) {
  const auto near_red = [](const std::vector<std::uint8_t>& v) {
    return v.size() == 6 && v[0] >= 253 && v[1] <= 2 && v[2] <= 2 && v[3] == v[0];
  };
  EXPECT_TRUE(near_red(rgb(PixelLayout::kYuyv, {2, 1}, {81, 90, 81, 240})));
  EXPECT_TRUE(near_red(rgb(PixelLayout::kYvyu, {2, 1}, {81, 240, 81, 90})));
  EXPECT_TRUE(near_red(rgb(PixelLayout::kUyvy, {2, 1}, {90, 81, 240, 81})));
  EXPECT_TRUE(near_red(rgb(PixelLayout::kVyuy, {2, 1}, {240, 81, 90, 81})));
}

// The same colour has another code in BT.709: Y 63, Cb 102, Cr 240.
TEST(PackedPixels, TheMatrixIsTheOneThatIsAskedFor) {
  const auto v = rgb(PixelLayout::kYuyv, {2, 1}, {63, 102, 63, 240}, kBt709);
  EXPECT_GE(v[0], 253);
  EXPECT_LE(v[1], 2);
}

TEST(PackedPixels, Nv12SharesChromaAmongFour) {
  EXPECT_THAT(rgb(PixelLayout::kNv12, {2, 2}, {16, 235, 235, 16, 128, 128}),
              ElementsAre(0, 0, 0, 255, 255, 255, 255, 255, 255, 0, 0, 0));
  EXPECT_NO_THROW(rgb(PixelLayout::kNv12, {1, 1}, {16, 0, 128, 128}));
}

TEST(PackedPixels, Rgb24AndBgr24DifferInOrderOnly) {
  EXPECT_THAT(rgb(PixelLayout::kRgb24, {1, 1}, {1, 2, 3}), ElementsAre(1, 2, 3));
  EXPECT_THAT(rgb(PixelLayout::kBgr24, {1, 1}, {3, 2, 1}), ElementsAre(1, 2, 3));
}

}  // namespace
}  // namespace patina
