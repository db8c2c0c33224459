// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/memory_tiff.h"

#include <gmock/gmock.h>
#include <tiffio.h>

#include "tests/processing/image/samples.h"

namespace patina {
namespace {

TEST(MemoryTiff, WritesAFileThatItReads) {
  MemoryTiff out = MemoryTiff::writing();
  TIFFSetField(out.handle(), TIFFTAG_IMAGEWIDTH, 3);
  TIFFSetField(out.handle(), TIFFTAG_IMAGELENGTH, 1);
  TIFFSetField(out.handle(), TIFFTAG_BITSPERSAMPLE, 8);
  std::uint8_t row[3] = {1, 2, 3};
  ASSERT_EQ(TIFFWriteScanline(out.handle(), row, 0, 0), 1);
  const Bytes file = out.finish();
  const MemoryTiff in = MemoryTiff::reading(file);
  EXPECT_EQ(in.longTag(TIFFTAG_IMAGEWIDTH, 0), 3u);
  EXPECT_EQ(in.shortTag(TIFFTAG_SAMPLESPERPIXEL, 9), 1);
  EXPECT_EQ(in.longTag(TIFFTAG_TILEWIDTH, 77), 77u);
}

TEST(MemoryTiff, KeepsTheErrorInsteadOfPrintingIt) {
  ::testing::internal::CaptureStderr();
  EXPECT_THAT(refusalOf([] { MemoryTiff::reading(bytesOf("II*")); }), ::testing::HasSubstr("TIFF"));
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
}

}  // namespace
}  // namespace patina
