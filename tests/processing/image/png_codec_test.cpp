// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "processing/image/alpha.h"
#include "processing/image/codecs.h"
#include "processing/image/linear_png.h"
#include "tests/processing/image/samples.h"
#include "tests/support/places.h"

namespace patina {
namespace {

template <class T>
Image<T> decoded(const Bytes& file) {
  return std::get<Image<T>>(codecs::decodePng(file, readPictureHeader(file)));
}

TEST(EncodePng, ComesBackBitForBit) {
  for (int channels : {1, 3}) {
    const auto low = gradient(37, 11, channels);
    EXPECT_EQ(decoded<std::uint8_t>(encodePng(low.view())).texels(), low.texels());
    Image<std::uint16_t> high(19, 23, channels);
    for (std::size_t i = 0; i < high.texels().size(); ++i)
      high.texels()[i] = static_cast<std::uint16_t>(i * 2477);
    EXPECT_EQ(decoded<std::uint16_t>(encodePng(std::as_const(high).view())).texels(),
              high.texels());
  }
}

TEST(EncodePng, ReadsRowsOfACropAndRefusesTwoChannels) {
  const auto whole = gradient(64, 64, 3);
  const auto crop = whole.view().crop({8, 8, 32, 32});
  EXPECT_EQ(encodePng(crop), encodePng(copyOf(crop).view()));
  EXPECT_THROW(encodePng(Image<std::uint8_t>(4, 4, 2).view()), ProcessingError);
}

TEST(EncodeLinearPng, IsReadAsLinearLightAndAPlainOneAsSrgb) {
  Image<std::uint16_t> half(4, 3, 1, 32768);
  half.at(0, 0) = 65535;
  const Bytes linear = encodeLinearPng(std::as_const(half).view());
  EXPECT_TRUE(isLinearPng(linear));
  EXPECT_NEAR(decodePicture(linear).linear.at(1, 1), 0.5, 1e-4);
  EXPECT_NEAR(decodePicture(linear).saturated_fraction, 1.0 / 12, 1e-9);
  const Bytes plain = encodePng(std::as_const(half).view());
  EXPECT_FALSE(isLinearPng(plain));
  EXPECT_NEAR(decodePicture(plain).linear.at(1, 1), 0.2140, 1e-3);
}

TEST(AlphaPng, ComesBackBesideItsColours) {
  auto colours = gradient(37, 11, 4);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 37; ++x) colours.at(x, y, 3) = static_cast<std::uint8_t>(250 - 5 * x - y);
  const Bytes file = encodeAlphaPng(std::as_const(colours).view());
  const Image<float> alpha = decodeAlpha(file);
  const Image<std::uint8_t> plain = decoded<std::uint8_t>(file);
  ASSERT_EQ(alpha.size(), colours.size());
  ASSERT_EQ(plain.channels(), 3);
  for (int y = 0; y < 11; ++y)
    for (int x = 0; x < 37; ++x) {
      ASSERT_EQ(alpha.at(x, y), static_cast<float>(colours.at(x, y, 3)) / 255);
      ASSERT_EQ(plain.at(x, y, 2), colours.at(x, y, 2));
    }
}

TEST(AlphaPng, IsNothingWhereThereIsNone) {
  EXPECT_TRUE(decodeAlpha(encodePng(gradient(9, 9, 3).view())).empty());
  EXPECT_TRUE(decodeAlpha(encodeJpeg(gradient(9, 9, 3).view())).empty());
  EXPECT_TRUE(decodeAlpha(Bytes{}).empty());
  Bytes damaged = encodeAlphaPng(gradient(40, 40, 4).view());
  damaged[damaged.size() / 2] ^= std::byte{1};
  EXPECT_THAT(refusalOf([&] { decodeAlpha(damaged); }), ::testing::HasSubstr("damaged"));
}

TEST(DecodePng, RefusesAWrongCheckSum) {
  Bytes file = encodePng(gradient(64, 48, 3).view());
  file[file.size() / 2] ^= std::byte{1};
  EXPECT_THAT(refusalOf([&] { decodePicture(file); }), ::testing::HasSubstr("damaged"));
}

TEST(DecodePng, ReadsRealPictures) {
  PATINA_TEST_DATA_OR_SKIP(folder, "textures");
  EXPECT_EQ(readPicture(folder / "brick.png").linear.channels(), 1);
  EXPECT_EQ(readPicture(folder / "coffee.png").linear.size(), (SizePx{600, 400}));
}

}  // namespace
}  // namespace patina
