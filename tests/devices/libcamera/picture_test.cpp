// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/picture.h"

#include <gmock/gmock.h>

#include "processing/image/dng_file.h"
#include "processing/image/linear_png.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace patina::devices::libcamera;
using namespace std::chrono_literals;

StreamFormat formatOf(const std::string& name, SizePx size, std::size_t row_bytes) {
  return {formatNamed(name), size, row_bytes, kBt601};
}

Bytes bytesOf(const std::vector<int>& values) {
  Bytes bytes;
  for (const int v : values) bytes.push_back(static_cast<std::byte>(v));
  return bytes;
}

TEST(LibcameraPicture, ColourComesBackPixelForPixel) {
  // Two pixels a row, padded to 8 bytes.
  const Bytes rgb = bytesOf({255, 0, 0, 0, 255, 0, 9, 9, 0, 0, 255, 255, 255, 255, 9, 9});
  const auto png = pictureFile(formatOf("BGR888", {2, 2}, 8), Wish::kPng, rgb, {});
  ASSERT_THAT(png, IsOk());
  const Picture picture = decodePicture(*png);
  EXPECT_NEAR(picture.linear.at(0, 0, 0), 1, 1e-6);
  EXPECT_NEAR(picture.linear.at(0, 0, 1), 0, 1e-6);
  EXPECT_NEAR(picture.linear.at(1, 0, 1), 1, 1e-6);
  EXPECT_NEAR(picture.linear.at(0, 1, 2), 1, 1e-6);
}

TEST(LibcameraPicture, AMosaicKeepsEverySampleAndSaysHowItWasTaken) {
  const Bytes raw = bytesOf({0x01, 0x0F, 0x02, 0x00, 0xFF, 0x0F, 0x00, 0x00});
  PictureFacts facts;
  facts.exposure.time = 20ms;
  facts.exposure.iso = Iso{400};
  facts.black_level = 256;
  const auto dng = pictureFile(formatOf("SGRBG12", {2, 2}, 4), Wish::kDng, raw, facts);
  ASSERT_THAT(dng, IsOk());
  const RawMosaic mosaic = decodeRaw(*dng);
  EXPECT_EQ(mosaic.samples.texels(), (std::vector<std::uint16_t>{0xF01, 2, 0xFFF, 0}));
  EXPECT_EQ(mosaic.cfa, (std::array<std::uint8_t, 4>{1, 0, 2, 1}));
  EXPECT_EQ(mosaic.black_level, 256);
  EXPECT_EQ(mosaic.white_level, 4095);
  EXPECT_EQ(mosaic.exposure, 20ms);
  EXPECT_EQ(mosaic.iso, Iso{400});
}

TEST(LibcameraPicture, GreyIsLinearAndWhiteIsWhite) {
  const auto png = pictureFile(formatOf("R8", {2, 1}, 2), Wish::kGrey, bytesOf({255, 51}), {});
  ASSERT_THAT(png, IsOk());
  EXPECT_TRUE(isLinearPng(*png));
  const Picture picture = decodePicture(*png);
  EXPECT_NEAR(picture.linear.at(0, 0), 1, 1e-6);
  EXPECT_NEAR(picture.linear.at(1, 0), 0.2, 1e-5);
}

TEST(LibcameraPicture, MotionJpegIsKeptAsItCame) {
  const Image<std::uint8_t> grey(8, 8, 3, 128);
  const Bytes jpeg = encodeJpeg(grey.view());
  const auto kept = pictureFile(formatOf("MJPEG", {8, 8}, 0), Wish::kJpeg, jpeg, {});
  ASSERT_THAT(kept, IsOk());
  EXPECT_EQ(*kept, jpeg);
  EXPECT_THAT(pictureFile(formatOf("MJPEG", {8, 16}, 0), Wish::kJpeg, jpeg, {}),
              Fails(Errc::kCorrupt));
}

TEST(LibcameraPicture, TooFewBytesAreCorrupt) {
  EXPECT_THAT(pictureFile(formatOf("NV12", {4, 4}, 4), Wish::kPng, Bytes(23), {}),
              Fails(Errc::kCorrupt));
  EXPECT_THAT(pictureFile(formatOf("NV12", {4, 4}, 4), Wish::kPng, Bytes(24), {}), IsOk());
}

TEST(LibcameraPicture, JpegIsMadeWhereThereIsNone) {
  const auto jpeg = pictureFile(formatOf("NV12", {4, 4}, 4), Wish::kJpeg, Bytes(24), {});
  ASSERT_THAT(jpeg, IsOk());
  EXPECT_EQ(sniffFormat(*jpeg), PictureFormat::kJpeg);
}

}  // namespace
}  // namespace patina::testing
