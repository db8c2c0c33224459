// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/kept_samples.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace patina {
namespace {

TEST(KeptSamples, OverTheFullScaleWhiteIsWhiteAndNoTwoBecomeOne) {
  Bytes data;
  for (int v = 0; v < 1024; ++v) {
    data.push_back(static_cast<std::byte>(v & 0xff));
    data.push_back(static_cast<std::byte>(v >> 8));
  }
  const auto full = unpackFullScale({data, {1024, 1}, PixelLayout::kLittle16, 10}).texels();
  EXPECT_EQ(full.front(), 0);
  EXPECT_EQ(full[512], 32800);  // 512 * 65535 / 1023 = 32799.53
  EXPECT_EQ(full.back(), 65535);
  EXPECT_TRUE(std::is_sorted(full.begin(), full.end()));
  EXPECT_EQ(std::adjacent_find(full.begin(), full.end()), full.end());
}

TEST(KeptSamples, AMosaicKnowsItsLevelsAndItsCell) {
  const Bytes data(8, std::byte{1});
  const RawMosaic raw = unpackMosaic({data, {2, 2}, PixelLayout::kLittle16, 12}, {2, 1, 1, 0}, 64);
  EXPECT_EQ(raw.samples.size(), (SizePx{2, 2}));
  EXPECT_EQ(raw.samples.at(1, 1), 0x101);
  EXPECT_EQ(raw.cfa, (std::array<std::uint8_t, 4>{2, 1, 1, 0}));
  EXPECT_EQ(raw.black_level, 64);
  EXPECT_EQ(raw.white_level, 4095);
}

}  // namespace
}  // namespace patina
