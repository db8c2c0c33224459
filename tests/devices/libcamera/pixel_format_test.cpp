// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/pixel_format.h"

#include <gmock/gmock.h>

#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace patina::devices::libcamera;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

CameraSettings wishing(Wish wish, SizePx size = {}) {
  CameraSettings settings;
  settings.who = "libcamera 'cam0'";
  settings.wish = wish;
  settings.size = size;
  return settings;
}

const std::vector<OfferedFormat> kOffered{{"NV12", {{640, 480}, {1920, 1080}}, {}, {}},
                                          {"RGB888", {{640, 480}}, {}, {}},
                                          {"SRGGB10_CSI2P", {{4056, 3040}, {2028, 1520}}, {}, {}},
                                          {"SRGGB12", {{2028, 1520}}, {}, {}},
                                          {"R8", {}, {16, 16}, {1280, 800}},
                                          {"XVUY8888", {{640, 480}}, {}, {}}};

TEST(PixelFormat, ColourIsTakenWhereLeastIsLost) {
  const auto choice = chooseStream(kOffered, wishing(Wish::kPng));
  ASSERT_THAT(choice, IsOk());
  EXPECT_EQ(choice->format->name, "RGB888");
  EXPECT_EQ(choice->size, (SizePx{640, 480}));
}

TEST(PixelFormat, TheSizeAskedForDecides) {
  const auto choice = chooseStream(kOffered, wishing(Wish::kJpeg, {1920, 1080}));
  ASSERT_THAT(choice, IsOk());
  EXPECT_EQ(choice->format->name, "NV12");
  EXPECT_EQ(choice->size, (SizePx{1920, 1080}));
}

TEST(PixelFormat, OfMosaicsTheOneWithTheMostBits) {
  EXPECT_EQ(chooseStream(kOffered, wishing(Wish::kDng))->format->name, "SRGGB12");
  const auto full = chooseStream(kOffered, wishing(Wish::kDng, {4056, 3040}));
  ASSERT_THAT(full, IsOk());
  EXPECT_EQ(full->format->name, "SRGGB10_CSI2P");
  EXPECT_EQ(full->format->layout, PixelLayout::kMipi);
}

TEST(PixelFormat, ARangeOfSizesHoldsWhatLiesWithin) {
  EXPECT_EQ(chooseStream(kOffered, wishing(Wish::kGrey))->size, (SizePx{1280, 800}));
  EXPECT_EQ(chooseStream(kOffered, wishing(Wish::kGrey, {100, 50}))->size, (SizePx{100, 50}));
  EXPECT_THAT(chooseStream(kOffered, wishing(Wish::kGrey, {1281, 800})), Fails(Errc::kRefused));
}

TEST(PixelFormat, WhatIsNotOfferedIsRefusedWithWhatIs) {
  const auto choice = chooseStream(kOffered, wishing(Wish::kPng, {800, 600}));
  ASSERT_THAT(choice, Fails(Errc::kRefused));
  EXPECT_THAT(choice.error().what, HasSubstr("NV12 640x480 1920x1080; RGB888 640x480"));
  EXPECT_THAT(choice.error().what, HasSubstr("R8 16x16 to 1280x800"));
}

TEST(PixelFormat, ManySizesAreCounted) {
  const std::vector<SizePx> sizes{{1, 1}, {2, 1}, {9, 9}, {3, 1}, {4, 1}, {5, 1}, {6, 1}};
  EXPECT_EQ(text({{"NV12", sizes, {}, {}}}), "NV12 in 7 sizes up to 9x9");
}

TEST(PixelFormat, MotionJpegIsTakenAsItComesWhereJpegIsWished) {
  const std::vector<OfferedFormat> offered{{"YUYV", {{640, 480}}, {}, {}},
                                           {"MJPEG", {{640, 480}}, {}, {}}};
  EXPECT_EQ(chooseStream(offered, wishing(Wish::kJpeg))->format->name, "MJPEG");
  EXPECT_EQ(chooseStream(offered, wishing(Wish::kPng))->format->name, "YUYV");
}

TEST(PixelFormat, TellsWhichFilesAStreamCouldGive) {
  EXPECT_THAT(wishesServed(kOffered), ElementsAre("png", "jpg", "dng", "grey"));
  EXPECT_THAT(wishesServed({{"MJPEG", {}, {}, {}}}), ElementsAre("jpg"));
  EXPECT_THAT(wishesServed({{"XVUY8888", {}, {}, {}}}), IsEmpty());
}

TEST(PixelFormat, NamesAreReadFromTheTopOfAWord) {
  EXPECT_EQ(formatNamed("BGR888")->layout, PixelLayout::kRgb24);
  EXPECT_EQ(formatNamed("RGB888")->layout, PixelLayout::kBgr24);
  EXPECT_EQ(formatNamed("SGBRG8")->cfa, (std::array<std::uint8_t, 4>{1, 2, 0, 1}));
  EXPECT_EQ(formatNamed("nothing"), nullptr);
}

}  // namespace
}  // namespace patina::testing
