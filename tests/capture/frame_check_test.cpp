// SPDX-License-Identifier: GPL-3.0-or-later
#include "capture/frame_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "processing/image/dng_file.h"
#include "processing/image/random.h"

namespace patina::capture {
namespace {

using ::testing::HasSubstr;

Image<std::uint8_t> picture(SizePx size, std::uint64_t seed) {
  Image<std::uint8_t> image(size.width, size.height, 3);
  std::uint64_t i = 0;
  for (auto& v : image.texels())
    v = static_cast<std::uint8_t>(uniformBelow(hashSeed(seed, i++), 200));
  return image;
}

devices::RawFrame frameOf(Bytes bytes, std::uint64_t sequence = 1) {
  devices::RawFrame f;
  f.ext = "jpg";
  f.bytes = std::move(bytes);
  f.sequence = sequence;
  f.declared_bytes = static_cast<std::int64_t>(f.bytes.size());
  return f;
}

struct Bench {
  devices::CameraCaps caps;
  devices::Ticket ticket;
  Bench() {
    caps.id = "cam0";
    caps.size = {64, 48};
    caps.bits = 8;
    caps.extensions = {"jpg"};
    ticket.sequence = 1;
  }
  devices::RawFrame jpeg(std::uint64_t seed = 1) const {
    return frameOf(encodeJpeg(picture(caps.size, seed).view()));
  }
  ShotCheck check(std::vector<devices::RawFrame> frames, bool lit = true) {
    kept = std::move(frames);
    return FrameCheck(caps, RectPx{0, 0, 16, 16}).check(kept, ticket, lit);
  }
  std::vector<devices::RawFrame> kept;
};

TEST(FrameCheck, KnowsThePictureOfAnEarlierProcessAgain) {
  Bench b;
  b.kept = {b.jpeg()};
  FrameCheck fresh(b.caps, {});
  EXPECT_EQ(fresh.check(b.kept, b.ticket, true).fault, FrameFault::kNone);
  fresh.recall({{0, sha256(b.kept[0].bytes), true}});
  EXPECT_EQ(fresh.check(b.kept, b.ticket, true).fault, FrameFault::kDuplicate);
}

TEST(TilesOf, AFileAreThoseThatItsCheckMeasures) {
  Bench b;
  const ShotCheck c = b.check({b.jpeg()});
  EXPECT_EQ(tilesOf(b.kept[0].bytes, {0, 0, 16, 16}).level, c.tiles->level);
}

TEST(FrameCheck, PassesAGoodPictureAndMeasuresItsPatch) {
  Bench b;
  const ShotCheck c = b.check({b.jpeg()});
  EXPECT_EQ(c.fault, FrameFault::kNone) << c.detail;
  ASSERT_EQ(c.frames.size(), 1u);
  EXPECT_EQ(c.frames[0].sha256, sha256(b.kept[0].bytes));
  EXPECT_EQ(c.frames[0].size, b.caps.size);
  ASSERT_TRUE(c.patch.has_value());
  EXPECT_GT(c.patch->level[0], 0.05);
}

TEST(FrameCheck, MeasuresARawPictureOnItsMosaic) {
  Bench b;
  b.caps.bits = 12;
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(64, 48, 1, 64 + 1000);
  for (int x = 0; x < 64; x += 2) raw.samples.at(x, 40) = 4095;
  raw.black_level = 64;
  raw.white_level = 4095;
  const ShotCheck c = b.check({frameOf(encodeDng(raw))});
  EXPECT_EQ(c.fault, FrameFault::kNone) << c.detail;
  EXPECT_NEAR(c.patch->level[1], 1000.0 / 4031, 1e-6);
  EXPECT_NEAR(c.saturated_fraction, 32.0 / (64 * 48), 1e-9);
  b.caps.bits = 14;
  EXPECT_EQ(b.check({frameOf(encodeDng(raw))}).fault, FrameFault::kWrongSize);
}

TEST(FrameCheck, LearnsTheSizeOfEachFileFromTheFirstGoodShot) {
  Bench b;
  b.caps.size = {};
  b.caps.bits = 0;
  FrameCheck frames(b.caps, RectPx{0, 0, 16, 16});
  const auto judge = [&](SizePx size, std::uint64_t seed) {
    b.kept = {frameOf(encodeJpeg(picture(size, seed).view()))};
    const ShotCheck c = frames.check(b.kept, b.ticket, true);
    frames.remember(c);
    return c.fault;
  };
  EXPECT_EQ(judge({80, 60}, 1), FrameFault::kNone);
  EXPECT_EQ(judge({64, 48}, 2), FrameFault::kWrongSize);
  EXPECT_EQ(judge({80, 60}, 3), FrameFault::kNone);
}

TEST(FrameCheck, LeavesAFileAloneThatItsDriversProcessDidNotSurvive) {
  Bench b;
  devices::RawFrame frame = b.jpeg();
  frame.seen = devices::Seen{"its decoder did not end", {}, 0, {}};
  const ShotCheck c = b.check({frame});
  EXPECT_EQ(c.fault, FrameFault::kDecode);
  EXPECT_THAT(c.detail, HasSubstr("did not end"));
}

TEST(FrameCheck, RefusesFilesCutShortAtAnyPlace) {
  Bench b;
  const devices::RawFrame whole = b.jpeg();
  for (std::size_t n = 0; n < whole.bytes.size(); n += whole.bytes.size() / 97 + 1) {
    devices::RawFrame cut = whole;
    cut.bytes.resize(n);
    EXPECT_EQ(b.check({cut}).fault, FrameFault::kLength) << n;
    cut.declared_bytes.reset();  // a camera that does not say
    EXPECT_NE(b.check({cut}).fault, FrameFault::kNone) << n;
  }
}

TEST(FrameCheck, RefusesWhatIsNoPictureAndPicturesOfAnotherSize) {
  Bench b;
  EXPECT_EQ(b.check({frameOf(Bytes(5000, std::byte{0x20}))}).fault, FrameFault::kDecode);
  const auto wrong = b.check({frameOf(encodeJpeg(picture({32, 24}, 1).view()))});
  EXPECT_EQ(wrong.fault, FrameFault::kWrongSize);
  EXPECT_THAT(wrong.detail, HasSubstr("32x24"));
}

TEST(FrameCheck, TakesAPngThatIsCalledJpegForWhatItIs) {
  Bench b;
  EXPECT_EQ(b.check({frameOf(encodePng(picture(b.caps.size, 3).view()))}).fault, FrameFault::kNone);
}

TEST(FrameCheck, RefusesThePreviousPictureReturnedAsNew) {
  Bench b;
  FrameCheck check(b.caps, {});
  const std::vector<devices::RawFrame> frames{b.jpeg()};
  const ShotCheck first = check.check(frames, b.ticket, true);
  ASSERT_EQ(first.fault, FrameFault::kNone);
  check.remember(first);
  EXPECT_EQ(check.check(frames, b.ticket, true).fault, FrameFault::kDuplicate);
  EXPECT_EQ(check.check({b.jpeg(2)}, b.ticket, true).fault, FrameFault::kNone);
  EXPECT_EQ(check.check(frames, b.ticket, false).fault, FrameFault::kDuplicate)
      << "a picture of the light is none of the dark";
}

TEST(FrameCheck, KnowsAPictureWhoseOtherFileCameCutShort) {
  Bench b;
  b.caps.extensions = {"jpg", "jpg"};
  for (const std::size_t spoilt : {0u, 1u}) {
    FrameCheck check(b.caps, {});
    std::vector<devices::RawFrame> whole{b.jpeg(1), b.jpeg(2)};
    whole[1].file_index = 1;
    auto cut = whole;
    cut[spoilt].bytes.resize(10);  // what all files begin with
    const ShotCheck refused = check.check(cut, b.ticket, true);
    ASSERT_EQ(refused.fault, FrameFault::kLength);
    check.remember(refused);
    EXPECT_EQ(check.check(whole, b.ticket, true).fault, FrameFault::kDuplicate) << spoilt;
  }
}

TEST(FrameCheck, KnowsTheLastGoodPictureThoughOthersFailedSince) {
  Bench b;
  FrameCheck check(b.caps, {});
  const std::vector<devices::RawFrame> good{b.jpeg(1)};
  check.remember(check.check(good, b.ticket, true));
  for (std::uint64_t seed = 100; seed < 150; ++seed) {
    const std::vector<devices::RawFrame> as_it_is{b.jpeg(seed)};
    auto refused = as_it_is;
    ++*refused[0].declared_bytes;
    check.remember(check.check(refused, b.ticket, true));
    EXPECT_EQ(check.check(as_it_is, b.ticket, true).fault, FrameFault::kDuplicate) << seed;
  }
  EXPECT_EQ(check.check(good, b.ticket, true).fault, FrameFault::kDuplicate);
}

TEST(FrameCheck, LetsTwoPicturesOfTheDarkBeEqual) {
  Bench b;
  FrameCheck check(b.caps, {});
  const std::vector<devices::RawFrame> frames{b.jpeg()};
  check.remember(check.check(frames, b.ticket, false));
  EXPECT_EQ(check.check(frames, b.ticket, false).fault, FrameFault::kNone);
}

Bytes darkDng(SizePx size, std::uint64_t seed) {
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(size.width, size.height, 1);
  std::uint64_t i = 0;
  for (auto& v : raw.samples.texels())
    v = static_cast<std::uint16_t>(62 + uniformBelow(hashSeed(seed, i++), 5));
  raw.black_level = 64;
  raw.white_level = 255;
  return encodeDng(raw);
}

TEST(FrameCheck, RefusesARawPictureOfTheDarkThatCameBefore) {
  Bench b;
  FrameCheck check(b.caps, {});
  const std::vector<devices::RawFrame> frames{frameOf(darkDng(b.caps.size, 1))};
  const ShotCheck first = check.check(frames, b.ticket, false);
  ASSERT_EQ(first.fault, FrameFault::kNone) << first.detail;
  check.remember(first);
  EXPECT_EQ(check.check(frames, b.ticket, false).fault, FrameFault::kDuplicate);
  EXPECT_EQ(check.check({frameOf(darkDng(b.caps.size, 2))}, b.ticket, false).fault,
            FrameFault::kNone);
}

TEST(FrameCheck, LetsRawPicturesWithoutAnyNoiseBeEqual) {
  Bench b;
  FrameCheck check(b.caps, {});
  RawMosaic raw;
  raw.samples = Image<std::uint16_t>(b.caps.size.width, b.caps.size.height, 1, 64);
  raw.black_level = 64;
  raw.white_level = 255;
  const std::vector<devices::RawFrame> frames{frameOf(encodeDng(raw))};
  check.remember(check.check(frames, b.ticket, false));
  EXPECT_EQ(check.check(frames, b.ticket, false).fault, FrameFault::kNone);
}

TEST(FrameCheck, LeavesABlackPictureToTheLight) {
  Bench b;
  FrameCheck check(b.caps, {});
  const Image<std::uint8_t> black(64, 48, 3);
  const std::vector<devices::RawFrame> frames{frameOf(encodeJpeg(black.view()))};
  for (int i = 0; i < 2; ++i) {
    const ShotCheck c = check.check(frames, b.ticket, true);
    EXPECT_EQ(c.fault, FrameFault::kNone);
    EXPECT_TRUE(c.all_equal);
    check.remember(c);
  }
}

TEST(FrameCheck, LetsALatePictureFillNoStep) {
  Bench b;
  devices::RawFrame late = b.jpeg(5);
  late.sequence = 77;
  EXPECT_EQ(b.check({late}).fault, FrameFault::kStaleSequence);
  const ShotCheck both = b.check({late, b.jpeg(6)});
  EXPECT_EQ(both.fault, FrameFault::kNone);
  ASSERT_EQ(both.frames.size(), 1u);
  EXPECT_EQ(both.frames[0].frame, &b.kept[1]);
  EXPECT_THAT(both.remarks, ::testing::ElementsAre(HasSubstr("fills no step")));
}

TEST(FrameCheck, KeepsAFileThatComesTwiceOnce) {
  Bench b;
  const ShotCheck c = b.check({b.jpeg(), b.jpeg()});
  EXPECT_EQ(c.fault, FrameFault::kNone);
  EXPECT_EQ(c.frames.size(), 1u);
  EXPECT_EQ(c.remarks.size(), 1u);
}

TEST(FrameCheck, MissesTheSecondFileOfAPair) {
  Bench b;
  b.caps.extensions = {"jpg", "dng"};
  EXPECT_EQ(b.check({b.jpeg()}).fault, FrameFault::kMissingFile);
  EXPECT_EQ(b.check({}).fault, FrameFault::kMissingFile);
}

TEST(FrameCheck, SaysWhenThePatchLiesOutsideThePicture) {
  Bench b;
  const std::vector<devices::RawFrame> frames{b.jpeg()};
  const auto c = FrameCheck(b.caps, RectPx{60, 0, 16, 16}).check(frames, b.ticket, true);
  EXPECT_EQ(c.fault, FrameFault::kWrongSize);
  EXPECT_THAT(c.detail, HasSubstr("patch"));
}

}  // namespace
}  // namespace patina::capture
