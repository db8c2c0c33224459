// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/raw_decode.h"

#include <gmock/gmock.h>

#include "tests/processing/image/samples.h"
#include "tests/support/places.h"

namespace patina {
namespace {

using ::testing::HasSubstr;

TEST(DecodeRaw, ReadsARealCamerasFile) {
  PATINA_TEST_DATA_OR_SKIP(path, "raw_dng/colorchart.dng");
  const Bytes file = readFile(path);
  EXPECT_FALSE(decodeOwnDng(file, {}).has_value());
  const RawMosaic raw = decodeRaw(file);
  EXPECT_EQ(raw.samples.size(), (SizePx{1734, 1156}));
  EXPECT_EQ(raw.make, "Canon");
  EXPECT_EQ(raw.model, "EOS Kiss X4");
  EXPECT_GT(raw.black_level, 0);
  EXPECT_GT(raw.white_level, raw.black_level);
  EXPECT_EQ(readPictureHeader(file).size, raw.samples.size());
}

TEST(DecodeRaw, RefusesARealFileCutShort) {
  PATINA_TEST_DATA_OR_SKIP(path, "raw_dng/colorchart.dng");
  const Bytes file = readFile(path);
  EXPECT_NE(refusalOf([&] { decodeRaw(std::span(file).first(file.size() / 2)); }), "");
}

TEST(DecodeRaw, RefusesWhatIsBeyondTheLimits) {
  const Bytes file = encodeDng(mosaic(64, 48));
  const PictureLimits small{.pixels_max = 1000};
  EXPECT_THAT(refusalOf([&] { decodeRaw(file, small); }), HasSubstr("64 x 48"));
  EXPECT_THAT(refusalOf([&] { decodeRawByLibRaw(file, small); }), HasSubstr("64 x 48"));
}

TEST(DecodeRaw, SurvivesDamageOnBothReaders) {
  const Bytes good = encodeDng(mosaic(64, 48));
  for (std::uint64_t i = 0; i < 300; ++i) {
    Bytes bad = good;
    // The directories lie behind the samples' and before them: hit what is not samples.
    const std::size_t at = uniformBelow(hashSeed(3, i), 620);
    bad[at < 310 ? at : bad.size() - 1 - (at - 310)] ^=
        static_cast<std::byte>(1 + hashSeed(4, i) % 255);
    for (const auto& read : {decodeRaw, decodeRawByLibRaw}) {
      try {
        read(bad, {.pixels_max = 1'000'000});
      } catch (const ProcessingError&) {
        // A clear refusal is as good as a picture.
      }
    }
  }
}

}  // namespace
}  // namespace patina
