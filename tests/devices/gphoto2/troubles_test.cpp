// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/troubles.h"

#include <gmock/gmock.h>

namespace patina::devices::gphoto2 {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string textOf(const std::vector<Trouble>& troubles) {
  std::string text;
  for (const Trouble& trouble : troubles) text += trouble.what + " -> " + trouble.do_this + "\n";
  return text;
}

SettingsSeen set(const std::string& name, const std::string& value) {
  Setting setting;
  setting.value = value;
  return {{name, setting}};
}

TEST(Troubles, ACameraOnManualHasNone) {
  SettingsSeen all;
  for (const auto& [name, value] : std::map<std::string, std::string>{{"iso", "100"},
                                                                      {"whitebalance", "Tungsten"},
                                                                      {"expprogram", "M"},
                                                                      {"focusmode", "Manual"},
                                                                      {"autoiso", "Off"},
                                                                      {"dlighting", "Off"},
                                                                      {"autopoweroff", "0"}})
    all.merge(set(name, value));
  EXPECT_THAT(troublesOfSettings(all), IsEmpty()) << textOf(troublesOfSettings(all));
}

TEST(Troubles, EveryAutomaticModeIsNamedWithItsValueAndItsCure) {
  const std::vector<std::pair<std::string, std::string>> automatic{
      {"iso", "Auto"},       {"autoiso", "On"},           {"whitebalance", "Automatic"},
      {"expprogram", "P"},   {"expprogram", "A"},         {"autoexposuremode", "AV"},
      {"focusmode", "AF-S"}, {"dlighting", "Extra high"}, {"hdrmode", "On"},
      {"bracketing", "On"},  {"autopoweroff", "60"},      {"autolightingoptimizer", "Standard"}};
  for (const auto& [name, value] : automatic) {
    const auto troubles = troublesOfSettings(set(name, value));
    ASSERT_EQ(troubles.size(), 1u) << name << " " << value;
    EXPECT_THAT(troubles[0].what, HasSubstr(value)) << name;
    EXPECT_FALSE(troubles[0].do_this.empty()) << name;
  }
}

TEST(Troubles, ABatteryIsNoMainsAndALowOneNoWeek) {
  EXPECT_TRUE(troublesOfBattery("100%", false).empty());
  EXPECT_TRUE(troublesOfBattery("15%", true).empty());
  ASSERT_EQ(troublesOfBattery("80%", false).size(), 1u);
  EXPECT_FALSE(troublesOfBattery("80%", false)[0].fatal);
  EXPECT_TRUE(troublesOfBattery("Low", false).at(0).fatal);
}

TEST(Troubles, ACardThatIsMissingFullOrLockedIsTold) {
  EXPECT_THAT(textOf(troublesOfCards({}, 0)), HasSubstr("no card"));
  EXPECT_THAT(troublesOfCards({{"SD", 64'000'000'000, 60'000'000'000, false}}, 5), IsEmpty());
  EXPECT_THAT(textOf(troublesOfCards({{"SD", 64'000'000'000, 500'000'000, false}}, 5)),
              HasSubstr("500 MB"));
  EXPECT_TRUE(troublesOfCards({{"SD", 64'000'000'000, 1, false}}, 5).at(0).fatal);
  EXPECT_THAT(textOf(troublesOfCards({{"SD", 64'000'000'000, 60'000'000'000, true}}, 5)),
              HasSubstr("lock"));
  EXPECT_THAT(textOf(troublesOfCards({{"SD", 64'000'000'000, 60'000'000'000, false}}, 9000)),
              HasSubstr("9000 files"));
}

TEST(Troubles, TheLibrarysFaultsAreKnownByVersion) {
  EXPECT_EQ(troublesOfLibrary("2.5.30").size(), 3u);
  EXPECT_EQ(troublesOfLibrary("2.5.33").size(), 1u);
  EXPECT_TRUE(troublesOfLibrary("2.5.34").empty());
  EXPECT_TRUE(troublesOfLibrary("unknown").empty());
}

FoundDevice found(const std::string& model, const std::string& serial, const std::string& address) {
  FoundDevice device;
  device.model = model;
  device.serial = serial;
  device.address = address;
  return device;
}

TEST(Troubles, BodiesThatNothingTellsApartNameEachOther) {
  std::vector<FoundDevice> cameras{
      found("D800", "0", "usb:001,002"), found("D800", "", "usb:001,003"),
      found("EOS", "12", "usb:001,004"), found("EOS", "13", "usb:001,005")};
  findTwins(cameras);
  ASSERT_EQ(cameras[0].troubles.size(), 1u);
  EXPECT_THAT(cameras[0].troubles[0].what, HasSubstr("usb:001,003"));
  EXPECT_TRUE(cameras[0].troubles[0].fatal);
  EXPECT_EQ(cameras[1].troubles.size(), 1u);
  EXPECT_TRUE(cameras[2].troubles.empty());
  EXPECT_TRUE(cameras[3].troubles.empty());
}

}  // namespace
}  // namespace patina::devices::gphoto2
