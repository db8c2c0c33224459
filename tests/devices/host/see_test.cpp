// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/host/see.h"

#include <gtest/gtest.h>

namespace patina::devices::host {
namespace {

Bytes png(SizePx size) {
  const Image<std::uint8_t> grey(size.width, size.height, 1, 90);
  return encodePng(grey.view());
}

TEST(See, APicturesSizeDepthAndThumbnail) {
  const Seen seen = see(png({512, 300}));
  EXPECT_EQ(seen.refused, "");
  EXPECT_EQ(seen.size, (SizePx{512, 300}));
  EXPECT_EQ(seen.bits, 8);
  EXPECT_EQ(readPictureHeader(seen.thumbnail).size, (SizePx{256, 150}));
}

TEST(See, ACutFileIsRefusedWithItsReason) {
  Bytes cut = png({64, 64});
  cut.resize(cut.size() / 2);
  EXPECT_NE(see(cut).refused, "");
  EXPECT_NE(see({}).refused, "");
}

}  // namespace
}  // namespace patina::devices::host
