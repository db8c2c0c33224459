// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/pixel_format.h"

#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <set>

namespace patina::devices::v4l2 {
namespace {

TEST(PixelFormats, AreEachThereOnceByNameAndByCode) {
  std::set<std::string> names;
  std::set<std::uint32_t> codes;
  for (const PixelFormat& format : pixelFormats()) {
    EXPECT_TRUE(names.insert(format.name).second) << format.name;
    EXPECT_TRUE(codes.insert(format.fourcc).second) << format.name;
    EXPECT_EQ(formatNamed(format.name), &format);
    EXPECT_EQ(formatOf(format.fourcc), &format);
  }
  EXPECT_EQ(formatNamed("h264"), nullptr);
  EXPECT_EQ(formatOf(V4L2_PIX_FMT_H264), nullptr);
}

// The kernel's document draws the first two rows: "BGBG.. GRGR..".
TEST(PixelFormats, HaveTheirColoursWhereTheirNamesSay) {
  using Cell = std::array<std::uint8_t, 4>;
  EXPECT_EQ(formatNamed("bggr8")->cfa, (Cell{2, 1, 1, 0}));
  EXPECT_EQ(formatNamed("gbrg10p")->cfa, (Cell{1, 2, 0, 1}));
  EXPECT_EQ(formatNamed("grbg12")->cfa, (Cell{1, 0, 2, 1}));
  EXPECT_EQ(formatNamed("rggb16")->cfa, (Cell{0, 1, 1, 2}));
}

TEST(FourccText, ReadsLikeTheKernelWritesIt) {
  EXPECT_EQ(fourccText(V4L2_PIX_FMT_YUYV), "YUYV");
  EXPECT_EQ(fourccText(V4L2_PIX_FMT_Y10), "Y10");
  EXPECT_EQ(fourccText(V4L2_PIX_FMT_Y16_BE), "Y16-BE");
}

}  // namespace
}  // namespace patina::devices::v4l2
