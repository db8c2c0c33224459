// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/fault/spoil_picture.h"

#include <gmock/gmock.h>

#include "processing/image/dng_file.h"

namespace patina::devices {
namespace {

Bytes bytesOf(std::size_t count) { return Bytes(count, std::byte{0x5a}); }

TEST(SpoilPicture, ACutFileIsABeginningOfItself) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const Bytes cut = cutShort(bytesOf(1000), seed);
    EXPECT_GE(cut.size(), 50u);
    EXPECT_LE(cut.size(), 950u);
  }
  EXPECT_EQ(cutShort(bytesOf(1000), 5), cutShort(bytesOf(1000), 5));
  EXPECT_TRUE(cutShort({}, 1).empty());
}

TEST(SpoilPicture, AChangedBlockIsWhollyChangedAndTheRestIsNot) {
  for (const std::size_t size : {1u, 2u, 7u, 700u, 5000u}) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Bytes original = bytesOf(size), changed = changeBlock(original, seed);
      ASSERT_EQ(changed.size(), size);
      std::size_t first = size, last = 0, differing = 0;
      for (std::size_t i = 0; i < size; ++i) {
        if (changed[i] == original[i]) continue;
        first = std::min(first, i);
        last = i;
        ++differing;
      }
      EXPECT_EQ(differing, std::min<std::size_t>(512, (size + 1) / 2));
      EXPECT_EQ(last - first + 1, differing);
    }
  }
}

TEST(SpoilPicture, ASmallerJpegStaysAJpeg) {
  Image<std::uint8_t> grey(40, 30, 3, 100);
  const auto small = shrinkPicture(encodeJpeg(std::as_const(grey).view()));
  ASSERT_TRUE(small.has_value());
  EXPECT_EQ(sniffFormat(*small), PictureFormat::kJpeg);
  EXPECT_EQ(readPictureHeader(*small).size, (SizePx{20, 14}));
}

TEST(SpoilPicture, ASmallerDngKeepsItsBayerCellsWhole) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(32, 24, 1);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 32; ++x)
      raw.samples.at(x, y) = static_cast<std::uint16_t>(1000 * (y % 2 * 2 + x % 2));
  raw.white_level = 4095;
  const auto small = shrinkPicture(encodeDng(raw));
  ASSERT_TRUE(small.has_value());
  const RawMosaic back = decodeRaw(*small);
  EXPECT_EQ(back.samples.size(), (SizePx{16, 12}));
  for (int y = 0; y < 12; ++y)
    for (int x = 0; x < 16; ++x)
      ASSERT_EQ(back.samples.at(x, y), 1000 * (y % 2 * 2 + x % 2)) << x << " " << y;
}

TEST(SpoilPicture, WhatIsNoPictureCannotBeMadeSmaller) {
  EXPECT_FALSE(shrinkPicture(bytesOf(100)).has_value());
  EXPECT_FALSE(shrinkPicture({}).has_value());
  Image<std::uint8_t> tiny(2, 2, 1);
  EXPECT_FALSE(shrinkPicture(encodePng(std::as_const(tiny).view())).has_value());
}

}  // namespace
}  // namespace patina::devices
