// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <tiffio.h>

#include <cstring>

#include "processing/image/encoding.h"
#include "processing/image/memory_tiff.h"
#include "tests/processing/image/samples.h"
#include "tests/support/matchers.h"

namespace patina {
namespace {

using ::testing::HasSubstr;

struct Form {
  int compression = COMPRESSION_NONE, tile = 0, photometric = PHOTOMETRIC_RGB, rows = 5;
  bool is_float = false;
};

template <class T>
Bytes tiffOf(const Image<T>& image, const Form& form = {}) {
  MemoryTiff out = MemoryTiff::writing();
  TIFF* tiff = out.handle();
  TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, image.width());
  TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, image.height());
  TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, static_cast<int>(sizeof(T) * 8));
  TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, image.channels());
  TIFFSetField(tiff, TIFFTAG_COMPRESSION, form.compression);
  TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, form.photometric);
  TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
  if (form.is_float) TIFFSetField(tiff, TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
  std::vector<T> row;
  if (form.tile == 0) {
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, form.rows);
    for (int y = 0; y < image.height(); ++y) {
      row.assign(image.view().row(y), image.view().row(y) + image.width() * image.channels());
      TIFFWriteScanline(tiff, row.data(), static_cast<std::uint32_t>(y), 0);
    }
    return out.finish();
  }
  TIFFSetField(tiff, TIFFTAG_TILEWIDTH, form.tile);
  TIFFSetField(tiff, TIFFTAG_TILELENGTH, form.tile);
  for (int y0 = 0; y0 < image.height(); y0 += form.tile)
    for (int x0 = 0; x0 < image.width(); x0 += form.tile) {
      row.assign(static_cast<std::size_t>(form.tile) * form.tile * image.channels(), T{});
      for (int y = 0; y < std::min(form.tile, image.height() - y0); ++y)
        for (int i = 0; i < std::min(form.tile, image.width() - x0) * image.channels(); ++i)
          row[static_cast<std::size_t>(y) * form.tile * image.channels() + i] =
              image.view().row(y0 + y)[x0 * image.channels() + i];
      TIFFWriteTile(tiff, row.data(), static_cast<std::uint32_t>(x0),
                    static_cast<std::uint32_t>(y0), 0, 0);
    }
  return out.finish();
}

TEST(DecodeTiff, ReadsStripsTilesAndCompressions) {
  const auto image = gradient(45, 33, 3);
  for (const Form& form : {Form{}, Form{.compression = COMPRESSION_LZW},
                           Form{.compression = COMPRESSION_ADOBE_DEFLATE}, Form{.tile = 16},
                           Form{.compression = COMPRESSION_LZW, .tile = 32}}) {
    const Picture picture = decodePicture(tiffOf(image, form));
    EXPECT_EQ(picture.format, PictureFormat::kTiff);
    EXPECT_EQ(encodeSrgb8(picture.linear.view()).texels(), image.texels()) << form.compression;
  }
}

TEST(DecodeTiff, TakesFloatsAsLinearAnd16BitsAsSrgb) {
  Image<float> light(9, 8, 1, 0.25f);
  const Form gray_float{.photometric = PHOTOMETRIC_MINISBLACK, .is_float = true};
  EXPECT_EQ(decodePicture(tiffOf(light, gray_float)).linear.texels(), light.texels());
  Image<std::uint16_t> codes(9, 8, 3, 32768);
  const Picture picture = decodePicture(tiffOf(codes));
  EXPECT_EQ(picture.bits, 16);
  EXPECT_NEAR(picture.linear.at(3, 3, 1), linearFromSrgb(32768 / 65535.0f), 1e-6);
}

TEST(DecodeTiff, TurnsWhiteIsZeroRoundAndDropsAlpha) {
  Image<std::uint8_t> dark(4, 4, 1, 255);
  EXPECT_EQ(decodePicture(tiffOf(dark, {.photometric = PHOTOMETRIC_MINISWHITE})).linear.at(1, 1),
            0);
  const auto rgba = gradient(8, 8, 4);
  EXPECT_EQ(decodePicture(tiffOf(rgba)).linear.channels(), 3);
}

TEST(DecodeTiff, RefusesSamplesBeyondTheEndAndUnknownKinds) {
  Bytes moved = tiffOf(gradient(64, 48, 3), {.rows = 48});
  // The entry of StripOffsets: tag 273, one LONG, the offset itself in the last four bytes.
  const Bytes entry = bytesOf(std::string("\x11\x01\x04\x00\x01\x00\x00\x00", 8));
  const auto at = std::search(moved.begin(), moved.end(), entry.begin(), entry.end());
  ASSERT_NE(at, moved.end());
  const auto offset = static_cast<std::uint32_t>(moved.size() - 100);
  std::memcpy(&*at + 8, &offset, 4);
  EXPECT_THAT(refusalOf([&] { decodePicture(moved); }), HasSubstr("lie beyond the end"));
  EXPECT_THAT(refusalOf([&] { readPictureHeader(moved); }), HasSubstr("lie beyond the end"));
  const Bytes whole = tiffOf(gradient(64, 48, 3));
  EXPECT_GT(countRefusedDamage(whole), 50);
  EXPECT_GT(countRefusedDamage(tiffOf(gradient(64, 48, 3), {.compression = COMPRESSION_LZW})), 50);
  Image<std::uint8_t> palette(4, 4, 1, 1);
  EXPECT_THAT(refusalOf([&] { decodePicture(tiffOf(palette, {.photometric = PHOTOMETRIC_MASK})); }),
              HasSubstr("not supported"));
}

}  // namespace
}  // namespace patina
