// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/exif_block.h"

#include <gtest/gtest.h>

#include "processing/image/dng_file.h"
#include "processing/image/metadata_file.h"

namespace patina {
namespace {

using namespace std::chrono_literals;

Bytes smallJpeg() { return encodeJpeg(Image<std::uint8_t>(16, 8, 3, 100).view()); }

TEST(JpegWithExif, IsReadBackBySomebodyElse) {
  const UtcTime taken = parseUtc("2024-05-01T12:00:00.123456789Z");
  const Bytes file = jpegWithExif(
      smallJpeg(), {12'500us, Iso{640}, FNumber{5.6}, taken, "Patina", "Patina DSLR", "1001"});
  const PictureMetadata said = readMetadata(file);
  EXPECT_EQ(said.taken_utc, taken);
  EXPECT_TRUE(said.has_utc_offset);
  EXPECT_EQ(said.exposure, 12'500us);
  EXPECT_EQ(said.iso, Iso{640});
  EXPECT_EQ(said.f_number, FNumber{5.6});
  EXPECT_EQ(said.camera, "Patina DSLR");
}

TEST(JpegWithExif, HasTheSamePixels) {
  const Bytes plain = smallJpeg();
  const Bytes file = jpegWithExif(plain, {1s, Iso{100}, {}, {}, "", "", ""});
  EXPECT_EQ(Bytes(file.end() - static_cast<std::ptrdiff_t>(plain.size() - 2), file.end()),
            Bytes(plain.begin() + 2, plain.end()));
  EXPECT_EQ(readPictureHeader(file).size, (SizePx{16, 8}));
  EXPECT_FALSE(readMetadata(file).taken_utc);
}

TEST(EncodeDng, KeepsTheSerialOfTheBody) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(8, 8, 1, 100);
  raw.serial = "1001";
  EXPECT_EQ(decodeRaw(encodeDng(raw)).serial, "1001");
}

}  // namespace
}  // namespace patina
