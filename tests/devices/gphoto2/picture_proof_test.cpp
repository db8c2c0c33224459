// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/picture_proof.h"

#include <gtest/gtest.h>

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;

constexpr MonoTime kNow = monoFromNs(5'000'000'000'000);
constexpr Nanoseconds kAhead = 24h * 365 * 20;

CardFile file(const std::string& name, const std::string& folder = "/store_1/DCIM/100X") {
  return {folder, name};
}

PictureMetadata takenAt(MonoTime t, Nanoseconds resolution = 10ms) {
  PictureMetadata picture;
  const UtcTime exact{t.time_since_epoch() + kAhead};
  picture.taken_utc = exact - exact.time_since_epoch() % resolution;
  return picture;
}

// A camera whose clock is known to 10 ms.
PictureJudge judgeAt(MonoTime t) {
  PictureJudge judge;
  const PictureMetadata seen = takenAt(t);
  judge.offset.observe(*seen.taken_utc, 10ms, t, t);
  return judge;
}

TEST(SeenNames, AFileIsKnownUntilItIsErased) {
  SeenNames names;
  names.note(file("DSC_0001.JPG"));
  EXPECT_TRUE(names.known(file("DSC_0001.JPG")));
  EXPECT_FALSE(names.known(file("DSC_0001.NEF")));
  names.erased(file("DSC_0001.JPG"));
  EXPECT_FALSE(names.known(file("DSC_0001.JPG")));
}

TEST(SeenNames, NumbersRiseWithinAFolderAndPrefix) {
  SeenNames names;
  names.note(file("DSC_0005.JPG"));
  EXPECT_FALSE(names.rises(file("DSC_0004.JPG")));
  EXPECT_TRUE(names.rises(file("DSC_0005.NEF")));
  EXPECT_TRUE(names.rises(file("DSC_0006.JPG")));
  EXPECT_TRUE(names.rises(file("IMG_0001.JPG")));
  EXPECT_TRUE(names.rises(file("DSC_0001.JPG", "/store_1/DCIM/101X")));
}

TEST(SeenNames, NumbersOutsideOfDcimMeanNothing) {
  SeenNames names;
  names.note(file("capt0007.cr2", "/"));
  EXPECT_TRUE(names.rises(file("capt0000.cr2", "/")));
}

TEST(SeenNames, StayBoundedOverALongRun) {
  SeenNames names;
  for (int i = 0; i < 5000; ++i) names.note(file("DSC_" + std::to_string(10000 + i) + ".JPG"));
  EXPECT_FALSE(names.known(file("DSC_10000.JPG")));
  EXPECT_TRUE(names.known(file("DSC_14999.JPG")));
  EXPECT_FALSE(names.rises(file("DSC_10000.JPG")));
}

TEST(PictureProof, APictureBetweenTriggerAndArrivalIsOurs) {
  PictureJudge judge = judgeAt(kNow);
  EXPECT_EQ(judge.judge(takenAt(kNow + 50ms), {kNow, kNow + 200ms}, true), Proof::kOurs);
}

TEST(PictureProof, ThePreviousPictureIsEarlier) {
  PictureJudge judge = judgeAt(kNow);
  EXPECT_EQ(judge.judge(takenAt(kNow - 130ms), {kNow, kNow + 200ms}, true), Proof::kEarlier);
}

TEST(PictureProof, APictureOfTheFutureIsNot) {
  PictureJudge judge = judgeAt(kNow);
  EXPECT_EQ(judge.judge(takenAt(kNow + 2s), {kNow, kNow + 200ms}, true), Proof::kLater);
}

TEST(PictureProof, BehindTheFenceNothingIsCertain) {
  PictureJudge judge = judgeAt(kNow);
  judge.fenceOff(kNow + 1s);
  EXPECT_EQ(judge.judge(takenAt(kNow + 1005ms), {kNow + 1s, kNow + 2s}, true), Proof::kUncertain);
}

// Whatever phase the camera's clock has: from tellable() on, the picture of a trigger is believed,
// and one from before the fence never.
TEST(PictureProof, FromTellableOnATriggersOwnPictureIsBelievedAndNoOther) {
  for (int phase = 0; phase < 37; ++phase) {
    const MonoTime begin = kNow + phase * 1ms;
    PictureJudge judge = judgeAt(begin);
    const MonoTime fence = begin + 300ms;
    judge.fenceOff(fence);
    const MonoTime told = judge.tellable();
    EXPECT_LE(told - fence, 30ms);
    EXPECT_EQ(judge.judge(takenAt(told), {told, told + 100ms}, true), Proof::kOurs) << phase;
    for (Nanoseconds before = 0ns; before < 100ms; before += 3ms)
      EXPECT_NE(judge.judge(takenAt(fence - before), {told, told + 100ms}, true), Proof::kOurs)
          << phase;
  }
}

TEST(PictureProof, EachAcceptedPictureNarrowsTheOffset) {
  PictureJudge judge;
  const PictureMetadata seen = takenAt(kNow, 1s);
  judge.offset.observe(*seen.taken_utc, 1s, kNow, kNow);
  EXPECT_GE(judge.offset.width(kNow), 1s);
  judge.accept(takenAt(kNow + 10ms), {kNow, kNow + 60ms});
  EXPECT_LE(judge.offset.width(kNow + 60ms), 80ms);
}

TEST(PictureProof, AZoneInThePicturesIsLearntOnceAndThenHeld) {
  PictureJudge judge = judgeAt(kNow);
  const auto zoned = [](MonoTime t) {
    PictureMetadata picture = takenAt(t);
    *picture.taken_utc -= 2h;  // the camera shows local time, its pictures name their zone
    picture.has_utc_offset = true;
    return picture;
  };
  EXPECT_EQ(judge.judge(zoned(kNow + 50ms), {kNow, kNow + 200ms}, true), Proof::kOurs);
  judge.accept(zoned(kNow + 50ms), {kNow, kNow + 200ms});
  EXPECT_EQ(judge.judge(zoned(kNow + 1h), {kNow + 1h - 10ms, kNow + 1h + 200ms}, true),
            Proof::kOurs);
  EXPECT_EQ(judge.judge(zoned(kNow + 45min), {kNow + 1h, kNow + 1h + 200ms}, true),
            Proof::kEarlier);
}

TEST(PictureProof, WithoutATimeTheNumberMustRiseAndNothingBeOpen) {
  PictureJudge judge = judgeAt(kNow);
  const PictureMetadata timeless;
  EXPECT_EQ(judge.judge(timeless, {kNow, kNow + 200ms}, true), Proof::kOurs);
  EXPECT_EQ(judge.judge(timeless, {kNow, kNow + 200ms}, false), Proof::kUncertain);
  judge.fenceOff(kNow);
  EXPECT_EQ(judge.judge(timeless, {kNow + 1s, kNow + 2s}, true), Proof::kUncertain);
  EXPECT_EQ(judge.judge(timeless, {kNow + 30s, kNow + 31s}, true), Proof::kOurs);
}

TEST(PictureProof, WholeSecondsWidenTheWaitUntilDigitsAreSeen) {
  TimeResolution resolution;
  EXPECT_EQ(resolution.value(), 10ms);
  resolution.observe(UtcTime{5s});
  EXPECT_EQ(resolution.value(), 1s);
  resolution.observe(UtcTime{5s + 320ms});
  EXPECT_EQ(resolution.value(), 10ms);
}

}  // namespace
}  // namespace patina::devices::gphoto2
