// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/encoding.h"
#include "processing/image/picture_file.h"
#include "tests/processing/image/samples.h"
#include "tests/support/matchers.h"

namespace patina {
namespace {

using testing::ImageNear;

TEST(EncodeJpeg, ComesBackWithinTwoCodes) {
  for (int channels : {1, 3}) {
    const auto stored = gradient(67, 45, channels);  // no multiple of a block
    const Picture picture = decodePicture(encodeJpeg(stored.view()));
    EXPECT_THAT(encodeSrgb8(picture.linear.view()), ImageNear(stored, 3.0));
  }
}

TEST(EncodeJpeg, KeepsColourAtFullResolutionAtHighQuality) {
  Image<std::uint8_t> stripes(64, 64, 3, 60);
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; x += 2) stripes.at(x, y, 0) = 200;
  const auto view = std::as_const(stripes).view();
  const auto contrast = [&](int quality) {
    const auto back = encodeSrgb8(decodePicture(encodeJpeg(view, quality)).linear.view());
    return (back.at(30, 30, 0) - back.at(31, 30, 0)) - (back.at(30, 30, 2) - back.at(31, 30, 2));
  };
  EXPECT_GT(contrast(95), 120);
  EXPECT_LT(contrast(80), 60);
}

TEST(EncodeJpeg, ReadsRowsOfACrop) {
  const auto whole = gradient(64, 64, 3);
  const auto crop = whole.view().crop({8, 8, 32, 32});
  EXPECT_EQ(encodeJpeg(crop), encodeJpeg(copyOf(crop).view()));
}

TEST(EncodeJpeg, RefusesWhatAJpegCannotHold) {
  EXPECT_THROW(encodeJpeg(Image<std::uint8_t>(4, 4, 2).view()), ProcessingError);
  EXPECT_THROW(encodeJpeg(Image<std::uint8_t>().view()), ProcessingError);
  EXPECT_THROW(encodeJpeg(gradient(4, 4, 3).view(), 0), ProcessingError);
}

TEST(DecodeJpeg, RefusesDamageThatLibjpegWouldPaintGray) {
  Bytes file = encodeJpeg(gradient(64, 48, 3).view());
  // A hole in the entropy-coded data: still a whole file by its markers.
  file.erase(file.end() - 120, file.end() - 60);
  EXPECT_THAT(refusalOf([&] { decodePicture(file); }), ::testing::HasSubstr("damaged"));
}

}  // namespace
}  // namespace patina
