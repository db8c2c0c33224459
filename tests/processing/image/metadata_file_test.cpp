// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/metadata_file.h"

#include <gmock/gmock.h>

#include <exiv2/exiv2.hpp>

#include "tests/processing/image/samples.h"

namespace patina {
namespace {

using Tags = std::vector<std::pair<const char*, const char*>>;

// A JPEG with these EXIF tags.
Bytes jpegWith(const Tags& tags) {
  const Bytes plain = encodeJpeg(gradient(16, 16, 3).view());
  const auto image = Exiv2::ImageFactory::open(reinterpret_cast<const Exiv2::byte*>(plain.data()),
                                               static_cast<long>(plain.size()));
  image->readMetadata();
  for (const auto& [key, value] : tags) image->exifData()[key] = value;
  image->writeMetadata();
  Exiv2::BasicIo& io = image->io();
  io.seek(0, Exiv2::BasicIo::beg);
  Bytes out(io.size());
  io.read(reinterpret_cast<Exiv2::byte*>(out.data()), static_cast<long>(out.size()));
  return out;
}

TEST(ReadMetadata, JoinsDateFractionAndOffset) {
  const auto said = readMetadata(jpegWith({{"Exif.Photo.DateTimeOriginal", "2024:05:01 14:00:00"},
                                           {"Exif.Photo.SubSecTimeOriginal", "25"},
                                           {"Exif.Photo.OffsetTimeOriginal", "+02:00"}}));
  EXPECT_EQ(said.taken_utc, parseUtc("2024-05-01T12:00:00.250Z"));
  EXPECT_TRUE(said.has_utc_offset);
}

TEST(ReadMetadata, TakesATimeWithoutOffsetAsUtcAndSaysSo) {
  const auto said =
      readMetadata(jpegWith({{"Exif.Photo.DateTimeOriginal", "2024:05:01 14:00:00"}}));
  EXPECT_EQ(said.taken_utc, parseUtc("2024-05-01T14:00:00Z"));
  EXPECT_FALSE(said.has_utc_offset);
}

TEST(ReadMetadata, TakesMalformedTimesAsAbsent) {
  EXPECT_FALSE(readMetadata(jpegWith({{"Exif.Photo.DateTimeOriginal", "0000:00:00 00:00:00"}}))
                   .taken_utc.has_value());
  EXPECT_FALSE(readMetadata(jpegWith({{"Exif.Photo.DateTimeOriginal", "    :  :     :  :  "}}))
                   .taken_utc.has_value());
  const auto said = readMetadata(jpegWith({{"Exif.Photo.DateTimeOriginal", "2024:05:01 14:00:00"},
                                           {"Exif.Photo.SubSecTimeOriginal", "x1"},
                                           {"Exif.Photo.OffsetTimeOriginal", "home"}}));
  EXPECT_EQ(said.taken_utc, parseUtc("2024-05-01T14:00:00Z"));
  EXPECT_FALSE(said.has_utc_offset);
}

TEST(ReadMetadata, ReadsHowTheLensWasSet) {
  const auto said = readMetadata(
      jpegWith({{"Exif.Photo.FocalLength", "350/10"}, {"Exif.Photo.SubjectDistance", "45/100"}}));
  EXPECT_EQ(said.focal_mm, 35);
  EXPECT_EQ(said.focus_m, 0.45);
  EXPECT_EQ(readMetadata(jpegWith({{"Exif.Photo.SubjectDistance", "4294967295/1"}})).focus_m, 1e6);
  EXPECT_FALSE(readMetadata(jpegWith({})).focal_mm);
}

TEST(ReadMetadata, ReadsExposureIsoApertureAndCamera) {
  const auto said = readMetadata(jpegWith({{"Exif.Photo.ExposureTime", "1/125"},
                                           {"Exif.Photo.FNumber", "56/10"},
                                           {"Exif.Photo.ISOSpeedRatings", "400"},
                                           {"Exif.Image.Make", "Nikon"},
                                           {"Exif.Image.Model", "Nikon D800"}}));
  EXPECT_EQ(said.exposure, Nanoseconds{8'000'000});
  EXPECT_EQ(said.f_number, FNumber{5.6});
  EXPECT_EQ(said.iso, Iso{400});
  EXPECT_EQ(said.camera, "Nikon D800");
}

TEST(ReadMetadata, TakesDivisionByZeroAsAbsent) {
  const auto said =
      readMetadata(jpegWith({{"Exif.Photo.ExposureTime", "1/0"}, {"Exif.Photo.FNumber", "0/0"}}));
  EXPECT_FALSE(said.exposure.has_value());
  EXPECT_FALSE(said.f_number.has_value());
}

TEST(ReadMetadata, ReadsOurDng) {
  const RawMosaic raw = mosaic(64, 48);
  const auto said = readMetadata(encodeDng(raw));
  EXPECT_EQ(said.taken_utc, raw.taken_utc);
  EXPECT_TRUE(said.has_utc_offset);
  EXPECT_EQ(said.exposure, raw.exposure);
  EXPECT_EQ(said.camera, "Patina Twin");
}

TEST(ReadMetadata, OfGarbageIsEmptyAndSilent) {
  ::testing::internal::CaptureStderr();
  EXPECT_FALSE(readMetadata({}).taken_utc.has_value());
  EXPECT_FALSE(readMetadata(bytesOf("no picture at all")).taken_utc.has_value());
  const Bytes good = jpegWith({{"Exif.Photo.DateTimeOriginal", "2024:05:01 14:00:00"}});
  for (std::uint64_t i = 0; i < 300; ++i) {
    Bytes bad = good;
    bad[uniformBelow(hashSeed(1, i), 200)] ^= static_cast<std::byte>(1 + hashSeed(2, i) % 255);
    readMetadata(bad);
  }
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace patina
