// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/picture.h"

#include <gmock/gmock.h>
#include <linux/videodev2.h>

#include "processing/image/dng_file.h"
#include "processing/image/linear_png.h"
#include "tests/devices/v4l2/attached_camera.h"
#include "tests/devices/v4l2/packed_samples.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

constexpr SizePx kSize{8, 6};

v4l2::FrameFormat formatOf(const v4l2::PixelFormat& pixel, SizePx size = kSize) {
  v4l2::FrameFormat format;
  format.pixel = &pixel;
  format.size = size;
  format.row_bytes = leastRowBytes(pixel.layout, pixel.bits, size.width);
  format.image_bytes = leastBytes({{}, size, pixel.layout, pixel.bits});
  return format;
}

v4l2::PictureFacts facts() {
  v4l2::PictureFacts f;
  f.exposure = {20ms, Iso{200}, FNumber{4}};
  f.utc = utcFromNs(1'714'564'800'000'000'000);
  f.model = "Simulated";
  f.black_level = 2;
  return f;
}

// A sample that has all bits in use somewhere.
std::uint16_t sampleAt(int i, int bits) {
  return static_cast<std::uint16_t>((i * 40'503u + 7) & ((1u << bits) - 1));
}

std::vector<std::uint16_t> samples(int bits) {
  std::vector<std::uint16_t> all;
  for (int i = 0; i < kSize.width * kSize.height; ++i) all.push_back(sampleAt(i, bits));
  return all;
}

TEST(PictureFile, EveryMosaicComesBackSampleBySample) {
  int formats = 0;
  for (const v4l2::PixelFormat& pixel : v4l2::pixelFormats()) {
    if (pixel.kind != v4l2::PixelFormat::kMosaic) continue;
    ++formats;
    const auto frame = packSamples(samples(pixel.bits), kSize, pixel.layout, pixel.bits);
    const auto file = v4l2::pictureFile(formatOf(pixel), frame, facts());
    ASSERT_THAT(file, IsOk()) << pixel.name;
    const RawMosaic raw = decodeRaw(*file);
    EXPECT_EQ(raw.samples.texels(), samples(pixel.bits)) << pixel.name;
    EXPECT_EQ(raw.cfa, pixel.cfa) << pixel.name;
    EXPECT_EQ(raw.white_level, (1 << pixel.bits) - 1) << pixel.name;
    EXPECT_EQ(raw.black_level, 2);
    EXPECT_EQ(v4l2::extensionFor(pixel), "dng");
    EXPECT_EQ(v4l2::bitsFor(pixel, v4l2::Transfer::kDriver), pixel.bits);
  }
  EXPECT_EQ(formats, 32);
}

TEST(PictureFile, EveryGreyFormatComesBackInLinearLight) {
  int formats = 0;
  for (const v4l2::PixelFormat& pixel : v4l2::pixelFormats()) {
    if (pixel.kind != v4l2::PixelFormat::kGrey) continue;
    ++formats;
    v4l2::FrameFormat format = formatOf(pixel);
    format.linear = true;
    const auto frame = packSamples(samples(pixel.bits), kSize, pixel.layout, pixel.bits);
    const auto file = v4l2::pictureFile(format, frame, facts());
    ASSERT_THAT(file, IsOk()) << pixel.name;
    EXPECT_TRUE(isLinearPng(*file));
    const Picture picture = decodePicture(*file);
    EXPECT_EQ(picture.bits, 16);
    const double white = (1 << pixel.bits) - 1;
    for (int i = 0; i < kSize.width * kSize.height; ++i)
      EXPECT_NEAR(picture.linear.texels()[static_cast<std::size_t>(i)] * white,
                  sampleAt(i, pixel.bits), 0.26)
          << pixel.name;
  }
  EXPECT_EQ(formats, 8);
}

TEST(PictureFile, GreyThatIsCodedForTheScreenStaysSo) {
  const v4l2::PixelFormat& grey = *v4l2::formatNamed("grey");
  const auto frame = packSamples(samples(8), kSize, grey.layout, 8);
  const auto file = v4l2::pictureFile(formatOf(grey), frame, facts());
  ASSERT_THAT(file, IsOk());
  EXPECT_FALSE(isLinearPng(*file));
  EXPECT_EQ(readPictureHeader(*file).bits, 8);
}

TEST(PictureFile, EveryColourFormatGivesTheGreyThatWasPacked) {
  for (const v4l2::PixelFormat& pixel : v4l2::pixelFormats()) {
    if (pixel.kind != v4l2::PixelFormat::kColour) continue;
    v4l2::FrameFormat format = formatOf(pixel);
    format.coding.full_range = true;
    const auto frame = packGrey(90, kSize, pixel.layout);
    const auto file = v4l2::pictureFile(format, frame, facts());
    ASSERT_THAT(file, IsOk()) << pixel.name;
    const Picture picture = decodePicture(*file);
    EXPECT_EQ(picture.linear.size(), kSize) << pixel.name;
    for (const float v : picture.linear.texels()) EXPECT_NEAR(v, 0.1022, 0.001) << pixel.name;
  }
}

TEST(PictureFile, PaddedRowsAreUnderstood) {
  const v4l2::PixelFormat& grey = *v4l2::formatNamed("grey");
  v4l2::FrameFormat format = formatOf(grey, {2, 2});
  format.row_bytes = 4;
  format.image_bytes = 8;
  const std::vector<std::byte> frame{std::byte{10}, std::byte{20}, {}, {},
                                     std::byte{30}, std::byte{40}, {}, {}};
  const auto file = v4l2::pictureFile(format, frame, facts());
  ASSERT_THAT(file, IsOk());
  EXPECT_NEAR(decodePicture(*file).linear.at(1, 1), 0.0212, 0.001);
}

TEST(PictureFile, AFrameOfAnotherLengthIsCorrupt) {
  const v4l2::PixelFormat& yuyv = *v4l2::formatNamed("yuyv");
  std::vector<std::byte> frame(formatOf(yuyv).image_bytes - 1);
  EXPECT_THAT(v4l2::pictureFile(formatOf(yuyv), frame, facts()), Fails(Errc::kCorrupt));
  frame.resize(formatOf(yuyv).image_bytes + 1);
  EXPECT_THAT(v4l2::pictureFile(formatOf(yuyv), frame, facts()), Fails(Errc::kCorrupt));
}

class MotionJpeg : public ::testing::Test {
 protected:
  Result<Bytes> file(const Bytes& frame) {
    return v4l2::pictureFile(formatOf(*v4l2::formatNamed("mjpeg"), {16, 8}), frame, facts());
  }
  Bytes jpeg(int width = 16) const {
    const Image<std::uint8_t> grey(width, 8, 1, 90);
    return encodeJpeg(grey.view());
  }
  // As cameras send them: without the Huffman tables, which everybody knows.
  static Bytes withoutTables(const Bytes& whole) {
    Bytes bare(whole.begin(), whole.begin() + 2);
    std::size_t at = 2;
    while (at + 4 < whole.size() && whole[at] == std::byte{0xFF}) {
      const std::size_t length = 2 + (std::to_integer<std::size_t>(whole[at + 2]) << 8 |
                                      std::to_integer<std::size_t>(whole[at + 3]));
      const bool scan = whole[at + 1] == std::byte{0xDA};
      const auto begin = whole.begin() + static_cast<std::ptrdiff_t>(at);
      const auto end = scan ? whole.end() : begin + static_cast<std::ptrdiff_t>(length);
      if (whole[at + 1] != std::byte{0xC4}) bare.insert(bare.end(), begin, end);
      if (scan) break;
      at += length;
    }
    return bare;
  }
};

TEST_F(MotionJpeg, IsKeptAsItCame) {
  EXPECT_EQ(*file(jpeg()), jpeg());
  Bytes padded = jpeg();
  padded.resize(padded.size() + 500);
  EXPECT_EQ(*file(padded), jpeg());
}

TEST_F(MotionJpeg, GetsTheTablesThatItLeavesOut) {
  const Bytes bare = withoutTables(jpeg());
  ASSERT_LT(bare.size() + 100, jpeg().size());
  const auto whole = file(bare);
  ASSERT_THAT(whole, IsOk());
  EXPECT_THAT(decodePicture(*whole).linear, ImageNear(decodePicture(jpeg()).linear, 1e-6));
}

TEST_F(MotionJpeg, ThatIsCutOrOfAnotherSizeOrNoneIsCorrupt) {
  Bytes cut = jpeg();
  cut.resize(cut.size() - 10);
  EXPECT_THAT(file(cut), Fails(Errc::kCorrupt));
  EXPECT_THAT(file(jpeg(24)), Fails(Errc::kCorrupt));
  EXPECT_THAT(file(Bytes(100, std::byte{7})), Fails(Errc::kCorrupt));
  EXPECT_THAT(file({}), Fails(Errc::kCorrupt));
}

}  // namespace
}  // namespace patina::testing
