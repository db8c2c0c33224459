// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/choices.h"

#include <gmock/gmock.h>

#include "tests/support/matchers.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using testing::Fails;
using ::testing::HasSubstr;
using testing::IsOk;

const Choices kNikon{"0.0080s", "0.0166s", "0.0333s", "1.0000s", "30.0000s", "Bulb", "Time"};
const Choices kCanon{"bulb", "30", "1.3", "0.8", "1/60", "1/125", "1/8000"};

TEST(Choices, ExposuresAreReadInEveryMakersSpelling) {
  EXPECT_EQ(exposureOf("1/125"), 8ms);
  EXPECT_EQ(exposureOf("0.0080s"), 8ms);
  EXPECT_EQ(exposureOf("0,8"), 800ms);
  EXPECT_EQ(exposureOf("30"), 30s);
  EXPECT_EQ(exposureOf("1 3/10"), 1300ms);
  EXPECT_EQ(exposureOf("10/13"), fromSeconds(10.0 / 13));
  EXPECT_EQ(exposureOf("2\""), 2s);
}

TEST(Choices, WhatIsNoTimeIsNone) {
  for (const char* none :
       {"Bulb", "Time", "auto", "", "1/0", "0", "1/125x", "x1", "1 2", "1/", "."})
    EXPECT_EQ(exposureOf(none), std::nullopt) << none;
}

TEST(Choices, IsoAndFNumbersToo) {
  EXPECT_EQ(isoOf("100"), Iso{100});
  EXPECT_EQ(isoOf("ISO 6400"), Iso{6400});
  for (const char* none : {"Auto", "Hi 1", "Lo 0.3", "", "0"}) EXPECT_EQ(isoOf(none), std::nullopt);
  EXPECT_EQ(fNumberOf("f/5.6"), FNumber{5.6});
  EXPECT_EQ(fNumberOf("8"), FNumber{8});
  for (const char* none : {"implicit auto", "", "0", "f/"})
    EXPECT_EQ(fNumberOf(none), std::nullopt) << none;
}

TEST(Choices, AnExposureIsMatchedByValue) {
  EXPECT_EQ(matchExposure(8ms, kNikon, "cam0").value(), "0.0080s");
  EXPECT_EQ(matchExposure(8ms, kCanon, "cam0").value(), "1/125");
  EXPECT_EQ(matchExposure(fromSeconds(1.0 / 60), kNikon, "cam0").value(), "0.0166s");
  EXPECT_EQ(matchExposure(800ms, kCanon, "cam0").value(), "0.8");
}

TEST(Choices, WhatIsMoreThanOnePerCentAwayIsNoMatchAndTheListIsTold) {
  const auto none = matchExposure(9ms, kCanon, "cam0");
  ASSERT_THAT(none, Fails(Errc::kUnsupported));
  for (const char* part : {"cam0", "0.009s", "bulb, 30", "1/8000"})
    EXPECT_THAT(none.error().what, HasSubstr(part)) << none.error().what;
  EXPECT_THAT(matchExposure(fromSeconds(0.00808), kCanon, "cam0"), IsOk());
  EXPECT_THAT(matchExposure(fromSeconds(0.00809), kCanon, "cam0"), Fails(Errc::kUnsupported));
}

TEST(Choices, ALensWithoutContactsIsToldHowToGoOn) {
  const auto none = matchFNumber(FNumber{8}, {"implicit auto"}, "cam0");
  ASSERT_THAT(none, Fails(Errc::kUnsupported));
  EXPECT_THAT(none.error().what, HasSubstr("manual"));
}

TEST(Choices, WordsAreMatchedInAnyCase) {
  EXPECT_EQ(matchWord("tungsten", {"Automatic", "Tungsten"}, "white_balance", "c").value(),
            "Tungsten");
  const auto none = matchWord("candle", {"Automatic", "Tungsten"}, "white_balance", "c");
  ASSERT_THAT(none, Fails(Errc::kUnsupported));
  EXPECT_THAT(none.error().what, HasSubstr("Automatic, Tungsten"));
}

TEST(Choices, AFormatIsKnownByTheFilesItGives) {
  EXPECT_EQ(fileKindsOf("NEF+Fine"), (FileKinds{true, true}));
  EXPECT_EQ(fileKindsOf("RAW + Large Fine JPEG"), (FileKinds{true, true}));
  EXPECT_EQ(fileKindsOf("NEF (Raw)"), (FileKinds{true, false}));
  EXPECT_EQ(fileKindsOf("Large Fine JPEG"), (FileKinds{false, true}));
  EXPECT_EQ(fileKindsOf("HEIF (Fine)"), std::nullopt);
  EXPECT_EQ(fileKindsOf("Unknown value 0007"), std::nullopt);
}

TEST(Choices, OfSeveralFormatsTheBestIsTaken) {
  const Choices canon{
      "Small JPEG", "Large Fine JPEG",        "Medium Fine JPEG", "mRAW",
      "RAW",        "mRAW + Large Fine JPEG", "RAW + Small JPEG", "RAW + Large Fine JPEG"};
  EXPECT_EQ(matchFormat({true, false}, canon, "c").value(), "RAW");
  EXPECT_EQ(matchFormat({false, true}, canon, "c").value(), "Large Fine JPEG");
  EXPECT_EQ(matchFormat({true, true}, canon, "c").value(), "RAW + Large Fine JPEG");
  const Choices nikon{"JPEG Basic", "JPEG Normal", "JPEG Fine",
                      "NEF (Raw)",  "NEF+Basic",   "NEF+Fine"};
  EXPECT_EQ(matchFormat({true, true}, nikon, "c").value(), "NEF+Fine");
  EXPECT_THAT(matchFormat({true, false}, {"JPEG Fine"}, "c"), Fails(Errc::kUnsupported));
}

TEST(Choices, AutomaticModesAreHeard) {
  for (const char* automatic : {"Auto", "Automatic", "P", "AI Servo", "AF-C", "Av"})
    EXPECT_TRUE(soundsAutomatic(automatic)) << automatic;
  for (const char* manual : {"M", "Manual", "Tungsten", "100", "Off"})
    EXPECT_FALSE(soundsAutomatic(manual)) << manual;
}

}  // namespace
}  // namespace patina::devices::gphoto2
