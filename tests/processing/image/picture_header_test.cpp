// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/picture_file.h"
#include "tests/processing/image/samples.h"
#include "tests/support/places.h"

namespace patina {
namespace {

using namespace std::string_literals;
using ::testing::HasSubstr;

void put16(Bytes& file, std::size_t at, unsigned value) {
  file[at] = static_cast<std::byte>(value >> 8);
  file[at + 1] = static_cast<std::byte>(value);
}
void put32(Bytes& file, std::size_t at, unsigned value) {
  put16(file, at, value >> 16);
  put16(file, at + 2, value & 0xffff);
}

std::size_t find(const Bytes& file, const std::string& what) {
  const Bytes wanted = bytesOf(what);
  return static_cast<std::size_t>(
      std::search(file.begin(), file.end(), wanted.begin(), wanted.end()) - file.begin());
}

TEST(ReadPictureHeader, TellsSizeChannelsAndBits) {
  const auto jpeg = readPictureHeader(encodeJpeg(gradient(33, 21, 3).view()));
  EXPECT_EQ(jpeg.format, PictureFormat::kJpeg);
  EXPECT_EQ(jpeg.size, (SizePx{33, 21}));
  EXPECT_EQ(jpeg.channels, 3);
  EXPECT_EQ(jpeg.bits, 8);
  const auto png = readPictureHeader(encodePng(Image<std::uint16_t>(5, 9, 1).view()));
  EXPECT_EQ(png.size, (SizePx{5, 9}));
  EXPECT_EQ(png.channels, 1);
  EXPECT_EQ(png.bits, 16);
  const auto dng = readPictureHeader(encodeDng(mosaic(32, 24)));
  EXPECT_EQ(dng.format, PictureFormat::kDng);
  EXPECT_EQ(dng.size, (SizePx{32, 24}));
}

TEST(ReadPictureHeader, RefusesAPngThatClaims100000By100000) {
  Bytes file = encodePng(gradient(8, 8, 3).view());
  put32(file, 16, 100'000);
  put32(file, 20, 100'000);
  EXPECT_THAT(refusalOf([&] { decodePicture(file); }), HasSubstr("100000 x 100000"));
}

TEST(ReadPictureHeader, RefusesClaimsBeyondTheBytesOrTheLimits) {
  Bytes jpeg = encodeJpeg(gradient(64, 48, 3).view());
  const std::size_t frame = find(jpeg, "\xFF\xC0"s);
  put16(jpeg, frame + 5, 65000);
  put16(jpeg, frame + 7, 65000);
  EXPECT_THAT(refusalOf([&] { decodePicture(jpeg); }), HasSubstr("65000 x 65000"));
  put16(jpeg, frame + 5, 10000);
  put16(jpeg, frame + 7, 10000);
  EXPECT_THAT(refusalOf([&] { decodePicture(jpeg); }), HasSubstr("more pixels than its bytes"));
  const Bytes small = encodePng(gradient(64, 48, 3).view());
  EXPECT_THAT(refusalOf([&] { decodePicture(small, {.pixels_max = 1000}); }), HasSubstr("64 x 48"));
  EXPECT_THAT(refusalOf([&] { decodePicture(small, {.decoded_bytes_max = 1000}); }),
              HasSubstr("64 x 48"));
}

TEST(ReadPictureHeader, RefusesAJpegOfManyScans) {
  Bytes file = encodeJpeg(gradient(8, 8, 1).view());
  const std::size_t scan = find(file, "\xFF\xDA"s);
  const Bytes one(file.begin() + static_cast<std::ptrdiff_t>(scan), file.end() - 2);
  for (int i = 0; i < 100; ++i) file.insert(file.end() - 2, one.begin(), one.end());
  EXPECT_THAT(refusalOf([&] { decodePicture(file); }), HasSubstr("100 scans"));
}

TEST(ReadPictureHeader, SaysThatATruncatedFileIsTruncated) {
  for (const Bytes& whole : {encodeJpeg(gradient(64, 48, 3).view()),
                             encodePng(gradient(64, 48, 3).view()), encodeDng(mosaic(64, 48))}) {
    const auto cut = std::span(whole).first(whole.size() - 40);
    EXPECT_THAT(refusalOf([&] { decodePicture(cut); }), HasSubstr("truncated"));
  }
}

TEST(ReadPictureHeader, DoesNotMindBytesAfterTheEndOfAJpeg) {
  Bytes file = encodeJpeg(gradient(16, 16, 3).view());
  file.insert(file.end(), 100, std::byte{0});
  EXPECT_EQ(decodePicture(file).linear.width(), 16);
}

TEST(SniffFormat, KnowsFormatsByTheirFirstBytes) {
  EXPECT_EQ(sniffFormat({}), PictureFormat::kUnknown);
  EXPECT_EQ(sniffFormat(bytesOf("GIF89a")), PictureFormat::kUnknown);
  EXPECT_EQ(sniffFormat(bytesOf("\xFF\xD8\xFF\xE1"s)), PictureFormat::kJpeg);
  EXPECT_EQ(sniffFormat(bytesOf("\x76\x2F\x31\x01"s)), PictureFormat::kExr);
  EXPECT_EQ(sniffFormat(bytesOf("II*\0\x10\0\0\0CR\2\0"s)), PictureFormat::kRaw);
  EXPECT_EQ(sniffFormat(bytesOf("FUJIFILMCCD-RAW 0201"s)), PictureFormat::kRaw);
  EXPECT_EQ(sniffFormat(bytesOf("II*\0"s)), PictureFormat::kTiff);
  PATINA_TEST_DATA_OR_SKIP(dng, "raw_dng/colorchart.dng");
  EXPECT_EQ(sniffFormat(readFile(dng)), PictureFormat::kDng);
}

TEST(DamagedFiles, AreRefusedOrReadButNeverCrash) {
  EXPECT_GT(countRefusedDamage(encodeJpeg(gradient(64, 48, 3).view())), 60);
  EXPECT_GT(countRefusedDamage(encodePng(gradient(64, 48, 3).view())), 300);
  EXPECT_GT(countRefusedDamage(encodeDng(mosaic(64, 48))), 60);
}

}  // namespace
}  // namespace patina
