// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/plain_tiff.h"

#include <gmock/gmock.h>
#include <tiffio.h>

#include <array>

#include "processing/image/memory_tiff.h"
#include "tests/processing/image/samples.h"

namespace patina {
namespace {

constexpr std::uint16_t kUnknownTag = 65'000;

Bytes headerOnly() { return bytesOf(std::string_view("II*\0\0\0\0\0", 8)); }

Bytes fileOf(const TiffDirectoryWriter& writer) {
  Bytes file = headerOnly();
  file.push_back(std::byte{7});  // the directory must not begin at an odd offset
  file[4] = static_cast<std::byte>(writer.appendTo(file));
  return file;
}

TiffDirectoryWriter someTags() {
  TiffDirectoryWriter writer;
  writer.size(TIFFTAG_IMAGEWIDTH, 70'000);
  writer.text(TIFFTAG_MODEL, "Twin");
  writer.text(TIFFTAG_MAKE, "P");
  writer.size(TIFFTAG_IMAGELENGTH, 48);
  writer.shorts(TIFFTAG_BITSPERSAMPLE, {16});
  writer.rationals(TIFFTAG_XRESOLUTION, TiffType::kRational, std::array{TiffRational{1, 300}});
  return writer;
}

TEST(TiffDirectory, ReadsWhatTheWriterWrote) {
  const Bytes file = fileOf(someTags());
  const auto directory = TiffDirectory::first(file);
  ASSERT_TRUE(directory.has_value());
  EXPECT_EQ(directory->number(TIFFTAG_IMAGEWIDTH), 70'000u);
  EXPECT_EQ(directory->number(TIFFTAG_IMAGELENGTH), 48u);
  EXPECT_EQ(directory->text(TIFFTAG_MAKE), "P");
  EXPECT_EQ(directory->text(TIFFTAG_MODEL), "Twin");
  EXPECT_EQ(directory->rational(TIFFTAG_XRESOLUTION)->bottom, 300u);
  EXPECT_TRUE(directory->has(TIFFTAG_MAKE));
}

TEST(TiffDirectory, HasNothingForWhatIsAbsentOrOfAnotherType) {
  const Bytes file = fileOf(someTags());
  const auto directory = TiffDirectory::first(file);
  ASSERT_TRUE(directory.has_value());
  EXPECT_FALSE(directory->has(kUnknownTag));
  EXPECT_FALSE(directory->number(kUnknownTag).has_value());
  EXPECT_FALSE(directory->number(TIFFTAG_MODEL).has_value());
  EXPECT_FALSE(directory->rational(TIFFTAG_IMAGEWIDTH).has_value());
  EXPECT_TRUE(directory->value(TIFFTAG_MAKE, TiffType::kByte, 2).empty());
  EXPECT_TRUE(directory->value(TIFFTAG_MAKE, TiffType::kText, 3).empty());
  EXPECT_EQ(directory->text(TIFFTAG_IMAGEWIDTH), "");
}

TEST(TiffDirectory, NeverReadsBeyondTheFile) {
  const Bytes whole = fileOf(someTags());
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(bytes));
    const auto directory = TiffDirectory::first(cut);
    if (!directory) continue;
    const auto resolution = directory->rational(TIFFTAG_XRESOLUTION);
    EXPECT_FALSE(resolution.has_value()) << "the last value lies beyond byte " << bytes;
  }
}

TEST(TiffDirectoryWriter, WritesWhatLibtiffReads) {
  TiffDirectoryWriter writer = someTags();
  writer.number(TIFFTAG_STRIPOFFSETS, TiffType::kLong, 8);
  writer.number(TIFFTAG_STRIPBYTECOUNTS, TiffType::kLong, 1);
  const Bytes file = fileOf(writer);
  const MemoryTiff in = MemoryTiff::reading(file);
  EXPECT_EQ(in.longTag(TIFFTAG_IMAGEWIDTH, 0), 70'000u);
  EXPECT_EQ(in.shortTag(TIFFTAG_BITSPERSAMPLE, 0), 16);
  const char* model = nullptr;
  ASSERT_TRUE(TIFFGetField(in.handle(), TIFFTAG_MODEL, &model));
  EXPECT_STREQ(model, "Twin");
  float resolution = 0;
  ASSERT_TRUE(TIFFGetField(in.handle(), TIFFTAG_XRESOLUTION, &resolution));
  EXPECT_FLOAT_EQ(resolution, 1.0f / 300);
}

}  // namespace
}  // namespace patina
