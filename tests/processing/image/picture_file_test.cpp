// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/picture_file.h"

#include <gmock/gmock.h>

#include "processing/image/encoding.h"
#include "tests/processing/image/samples.h"
#include "tests/support/matchers.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

using ::testing::HasSubstr;
using testing::ImageNear;
using testing::TempFolder;

TEST(DecodePicture, TakesPngAsSrgbAndGivesLinearLight) {
  const auto stored = gradient(31, 17, 3);
  const Picture picture = decodePicture(encodePng(stored.view()));
  EXPECT_EQ(picture.format, PictureFormat::kPng);
  EXPECT_EQ(picture.bits, 8);
  EXPECT_EQ(encodeSrgb8(picture.linear.view()).texels(), stored.texels());
}

TEST(DecodePicture, CountsTheShareOfSaturatedSamples) {
  Image<std::uint8_t> stored(10, 10, 3, 100);
  for (int x = 0; x < 10; ++x) stored.at(x, 0, 2) = 255;
  EXPECT_NEAR(decodePicture(encodePng(std::as_const(stored).view())).saturated_fraction, 10 / 300.0,
              1e-12);
  RawMosaic raw = mosaic(10, 10);
  for (int x = 0; x < 10; ++x) raw.samples.at(x, 0) = 4095;
  EXPECT_NEAR(decodePicture(encodeDng(raw)).saturated_fraction, 0.1, 1e-12);
}

TEST(ReadPicture, NamesTheFileThatIsBad) {
  const TempFolder folder;
  testing::writeFile(folder / "a.jpg", "");
  testing::writeFile(folder / "b.jpg", "this is text, not light");
  EXPECT_THAT(refusalOf([&] { readPicture(folder / "a.jpg"); }),
              ::testing::AllOf(HasSubstr("a.jpg"), HasSubstr("empty (0 bytes)")));
  EXPECT_THAT(refusalOf([&] { readPicture(folder / "b.jpg"); }), HasSubstr("not a picture"));
  EXPECT_THAT(refusalOf([&] { readPicture(folder / "absent.jpg"); }), HasSubstr("absent.jpg"));
}

TEST(ReadPicture, GoesByTheBytesAndNotByTheName) {
  const TempFolder folder;
  writePng(folder / "really_a_png.jpg", gradient(8, 8, 3).view());
  EXPECT_EQ(readPicture(folder / "really_a_png.jpg").format, PictureFormat::kPng);
}

TEST(ReadPicture, ReadsTheRealOnes) {
  PATINA_TEST_DATA_OR_SKIP(folder, "chessboards");
  const Picture gray = readPicture(folder / "left01.jpg");
  EXPECT_EQ(gray.linear.size(), (SizePx{640, 480}));
  EXPECT_EQ(gray.linear.channels(), 1);
  const Picture colour = readPicture(folder / "aloeL.jpg");
  EXPECT_EQ(colour.linear.channels(), 3);
}

TEST(WriteExr, ComesBackBitForBit) {
  const TempFolder folder;
  Image<float> linear(13, 7, 3);
  for (std::size_t i = 0; i < linear.texels().size(); ++i)
    linear.texels()[i] = static_cast<float>(uniform(i) * 8 - 1);
  writeExr(folder / "a.exr", std::as_const(linear).view());
  EXPECT_EQ(readPicture(folder / "a.exr").linear.texels(), linear.texels());
}

TEST(ExtensionOf, NamesEveryFormat) {
  EXPECT_EQ(extensionOf(PictureFormat::kJpeg), "jpg");
  EXPECT_EQ(extensionOf(PictureFormat::kPng), "png");
  EXPECT_EQ(extensionOf(PictureFormat::kTiff), "tif");
  EXPECT_EQ(extensionOf(PictureFormat::kExr), "exr");
  EXPECT_EQ(extensionOf(PictureFormat::kDng), "dng");
}

}  // namespace
}  // namespace patina
