// SPDX-License-Identifier: GPL-3.0-or-later
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <ImfPartType.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

#include "processing/image/alpha.h"
#include "processing/image/codecs.h"
#include "tests/processing/image/samples.h"
#include "tests/support/places.h"
#include "tests/support/temp_folder.h"

namespace patina {
namespace {

Image<float> wild(int channels) {
  Image<float> out(21, 34, channels);
  for (std::size_t i = 0; i < out.texels().size(); ++i)
    out.texels()[i] = static_cast<float>(gaussian(i) * 100);
  return out;
}

TEST(EncodeExr, KeepsFloatsOutsideZeroToOne) {
  for (int channels : {1, 3}) {
    const auto in = wild(channels);
    const Picture out = decodePicture(codecs::encodeExr(in.view()));
    EXPECT_EQ(out.linear.texels(), in.texels());
    EXPECT_EQ(out.bits, 32);
  }
}

TEST(AlphaExr, ComesBackBesideItsColours) {
  const Image<float> in = wild(4);
  const Bytes file = encodeAlphaExr(in.view());
  const Image<float> colours = decodePicture(file).linear, alpha = decodeAlpha(file);
  ASSERT_EQ(colours.channels(), 3);
  ASSERT_EQ(alpha.channels(), 1);
  for (int y = 0; y < in.height(); ++y)
    for (int x = 0; x < in.width(); ++x) {
      ASSERT_EQ(alpha.at(x, y), in.at(x, y, 3));
      ASSERT_EQ(colours.at(x, y, 2), in.at(x, y, 2));
    }
}

TEST(AlphaExr, IsNothingWhereThereIsNoneAndRefusedWhereDamaged) {
  EXPECT_TRUE(decodeAlpha(codecs::encodeExr(wild(3).view())).empty());
  EXPECT_TRUE(decodeAlpha(codecs::encodeExr(wild(1).view())).empty());
  const Bytes file = encodeAlphaExr(wild(4).view());
  EXPECT_THROW(decodeAlpha(std::span(file).first(file.size() / 2)), ProcessingError);
}

TEST(DecodeExr, RefusesEveryTruncationAndSurvivesDamage) {
  const Bytes file = codecs::encodeExr(wild(3).view());
  for (int i = 1; i < 50; ++i) {
    const auto cut = std::span(file).first(file.size() * i / 50);
    EXPECT_THROW(decodePicture(cut), ProcessingError) << i;
  }
  EXPECT_GT(countRefusedDamage(file), 50);
}

TEST(DecodeExr, RefusesAnAttributeLongerThanTheFileBeforeRoomIsMadeForIt) {
  Bytes file = codecs::encodeExr(wild(1).view());
  const std::string type = "chlist";
  const auto bytes = std::as_bytes(std::span(type));
  const auto found = std::search(file.begin(), file.end(), bytes.begin(), bytes.end());
  ASSERT_NE(found, file.end());
  found[10] = std::byte{0x7f};  // of its length, after the text and its zero: 2 GB
  try {
    decodePicture(file);
    FAIL();
  } catch (const ProcessingError& error) {
    EXPECT_THAT(error.what(), ::testing::HasSubstr("longer than the file"));
  }
}

TEST(DecodeExr, ReadsTheFirstOfSeveralParts) {
  std::vector<Imf::Header> headers(2, Imf::Header(8, 8));
  for (std::size_t i = 0; i < 2; ++i) {
    headers[i].setName("part" + std::to_string(i));
    headers[i].setType(Imf::SCANLINEIMAGE);
    headers[i].channels().insert("Y", Imf::Channel(Imf::FLOAT));
  }
  const testing::TempFolder folder;
  const std::filesystem::path path = folder.path() / "parts.exr";
  {
    Imf::MultiPartOutputFile out(path.c_str(), headers.data(), 2);
    for (int i = 0; i < 2; ++i) {
      std::vector<float> level(64, static_cast<float>(i + 1));
      Imf::FrameBuffer buffer;
      buffer.insert("Y", Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(level.data()), 4, 32));
      Imf::OutputPart part(out, i);
      part.setFrameBuffer(buffer);
      part.writePixels(8);
    }
  }
  EXPECT_EQ(readPicture(path).linear.at(3, 3), 1.0F);
}

TEST(DecodeExr, ReadsTheRealHalfFloatMaps) {
  PATINA_TEST_DATA_OR_SKIP(folder, "snowyground_stbrdf");
  const Picture diffuse = readPicture(folder / "Diffuse-0.exr");
  EXPECT_EQ(diffuse.linear.size(), (SizePx{512, 512}));
  EXPECT_EQ(diffuse.bits, 16);
}

}  // namespace
}  // namespace patina
