// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/dng_file.h"

#include <gmock/gmock.h>

#include "processing/image/raw_decode.h"
#include "processing/image/sha256.h"
#include "tests/processing/image/samples.h"

namespace patina {
namespace {

void expectSame(const RawMosaic& got, const RawMosaic& want) {
  EXPECT_EQ(got.samples.size(), want.samples.size());
  EXPECT_EQ(got.samples.texels(), want.samples.texels());
  EXPECT_EQ(got.cfa, want.cfa);
  EXPECT_EQ(got.black_level, want.black_level);
  EXPECT_EQ(got.white_level, want.white_level);
  EXPECT_EQ(got.exposure, want.exposure);
  EXPECT_EQ(got.iso, want.iso);
  EXPECT_EQ(got.f_number, want.f_number);
  EXPECT_EQ(got.taken_utc, want.taken_utc);
  EXPECT_EQ(got.make, want.make);
  EXPECT_EQ(got.model, want.model);
}

TEST(EncodeDng, GivesLibRawAndTheQuickReaderEveryValue) {
  const RawMosaic raw = mosaic(64, 48);
  const Bytes file = encodeDng(raw);
  expectSame(decodeRawByLibRaw(file, {}), raw);
  const auto own = decodeOwnDng(file, {});
  ASSERT_TRUE(own.has_value());
  expectSame(*own, raw);
}

TEST(EncodeDng, KeepsEveryFilterOrderAndOddSizes) {
  for (const std::array<std::uint8_t, 4> cfa :
       {std::array<std::uint8_t, 4>{0, 1, 1, 2}, {2, 1, 1, 0}, {1, 0, 2, 1}, {1, 2, 0, 1}}) {
    RawMosaic raw = mosaic(66, 50);
    raw.cfa = cfa;
    const Bytes file = encodeDng(raw);
    expectSame(decodeRawByLibRaw(file, {}), raw);
    expectSame(decodeRaw(file), raw);
  }
}

TEST(EncodeDng, KeepsExposuresToTheNanosecond) {
  for (std::int64_t ns : {1ll, 125'000ll, 16'666'667ll, 123'456'789ll, 700'000'000ll,
                          4'000'000'001ll, 30'000'000'000ll}) {
    RawMosaic raw = mosaic(64, 48);
    raw.exposure = Nanoseconds{ns};
    const Bytes file = encodeDng(raw);
    EXPECT_EQ(decodeRaw(file).exposure, raw.exposure);
    EXPECT_EQ(decodeRawByLibRaw(file, {}).exposure, raw.exposure);
  }
}

TEST(EncodeDng, LeavesOutWhatIsUnknown) {
  RawMosaic raw = mosaic(64, 48);
  raw.exposure.reset();
  raw.iso.reset();
  raw.f_number.reset();
  raw.taken_utc.reset();
  const Bytes file = encodeDng(raw);
  expectSame(decodeRaw(file), raw);
  expectSame(decodeRawByLibRaw(file, {}), raw);
}

// Frames are named by their hashes, and a seed promises them.
TEST(EncodeDng, WritesTheSameBytesAsEver) {
  RawMosaic raw = mosaic(64, 48);
  EXPECT_EQ(sha256(encodeDng(raw)).hex(),
            "e04323b31b1dcb8d1f8924f5ad410dba7ae2bd07b4ffaa3422fed893aa1f8112");
  raw = mosaic(302, 201);
  raw.model = "M";
  raw.exposure = Nanoseconds{30'000'000'000};
  raw.iso.reset();
  EXPECT_EQ(sha256(encodeDng(raw)).hex(),
            "7b7fa636f7efa582715bca99826b4d364f902dfae1318341ae5eb56add2da21b");
  raw.exposure.reset();
  raw.f_number.reset();
  raw.taken_utc.reset();
  EXPECT_EQ(sha256(encodeDng(raw)).hex(),
            "b9180cedf5b5751c087475bb67f8d16b0262bda9ebff1adfdbdf7744da02b1d7");
}

TEST(EncodeDng, KeepsABlackLevelBetweenTwoSamples) {
  RawMosaic raw = mosaic(64, 48);
  raw.black_level = 63.625;
  EXPECT_EQ(decodeRaw(encodeDng(raw)).black_level, 63.625);
}

TEST(EncodeDng, IsPureAndRefusesNonsense) {
  EXPECT_EQ(encodeDng(mosaic(64, 48)), encodeDng(mosaic(64, 48)));
  RawMosaic raw = mosaic(64, 48);
  raw.white_level = 10;
  EXPECT_THROW(encodeDng(raw), ProcessingError);
  raw = mosaic(64, 48);
  raw.iso = Iso{1e9};
  EXPECT_THROW(encodeDng(raw), ProcessingError);
  EXPECT_THROW(encodeDng({}), ProcessingError);
}

}  // namespace
}  // namespace patina
