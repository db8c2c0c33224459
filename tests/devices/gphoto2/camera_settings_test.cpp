// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/gphoto2/camera_settings.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"
#include "devices/gphoto2/gphoto2.h"

namespace patina::devices::gphoto2 {
namespace {

using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

CameraSpec spec(std::map<std::string, std::string> settings, const std::string& serial = "") {
  CameraSpec s;
  s.id = "cam0";
  s.backend = "gphoto2";
  s.serial = serial;
  s.settings = std::move(settings);
  return s;
}

std::string problemOf(const CameraSpec& s) {
  try {
    readCameraSettings(s, "rig.toml");
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "none";
}

TEST(Gphoto2Settings, HaveDefaultsForACameraOnUsb) {
  const CameraSettings s = readCameraSettings(spec({}), "rig.toml");
  EXPECT_TRUE(s.addresses.empty());
  EXPECT_EQ(s.files, (FileKinds{true, false}));
  EXPECT_THAT(s.extensions(), ElementsAre("raw"));
  EXPECT_EQ(s.target, Target::kCard);
  EXPECT_FALSE(s.keep);
  EXPECT_EQ(s.cycle, 1500ms);
  EXPECT_EQ(s.exposure_max, 30s);
}

TEST(Gphoto2Settings, TakeAFormatsOwnWordAndAFreeSetting) {
  const CameraSettings s = readCameraSettings(
      spec({{"format", "NEF+Fine"}, {"raw_extension", "NEF"}, {"config.dff1", "2"}}), "rig.toml");
  EXPECT_EQ(s.format_word, "NEF+Fine");
  EXPECT_THAT(s.extensions(), ElementsAre("nef", "jpg"));
  EXPECT_EQ(s.config.at("dff1"), "2");
}

TEST(Gphoto2Settings, NameNetworkCamerasByHostAndPort) {
  const CameraSettings s = readCameraSettings(
      spec({{"host", "10.0.0.5, 10.0.0.6:15741"}, {"port", "15742"}}, "77"), "rig.toml");
  ASSERT_EQ(s.addresses.size(), 2u);
  EXPECT_EQ(s.addresses[0].model, "PTP/IP Camera");
  EXPECT_EQ(s.addresses[0].port, "ptpip:10.0.0.5:15742:15742");
  EXPECT_EQ(s.addresses[1].port, "ptpip:10.0.0.6:15741:15741");
}

TEST(Gphoto2Settings, RefuseWhatIsWrongAndSayWhatIsAllowed) {
  EXPECT_THAT(problemOf(spec({{"shuter", "x"}})), HasSubstr("shutter"));
  EXPECT_THAT(problemOf(spec({{"format", "heif"}})), HasSubstr("raw, jpeg, raw+jpeg"));
  EXPECT_THAT(problemOf(spec({{"host", "a:99999"}})), HasSubstr("1 to 65535"));
  EXPECT_THAT(problemOf(spec({{"host", "a,b"}})), HasSubstr("serial"));
  EXPECT_THAT(problemOf(spec({{"target", "cloud"}})), HasSubstr("card, memory"));
  EXPECT_THAT(problemOf(spec({{"target", "memory"}, {"keep", "true"}})), HasSubstr("keep"));
  EXPECT_THAT(problemOf(spec({{"exposure_min", "2s"}, {"exposure_max", "1s"}})),
              HasSubstr("exposure_min"));
  EXPECT_THAT(problemOf(spec({{"serial", "5"}}, "6")), HasSubstr("serial"));
}

TEST(Gphoto2Settings, AMadeCameraHasTouchedNothing) {
  RealClock clock;
  const auto camera =
      makeCamera(spec({{"host", "192.0.2.1"}, {"model", "Nikon D800"}}, "77"), "rig.toml", clock);
  EXPECT_EQ(camera->caps().id, "cam0");
  EXPECT_EQ(camera->caps().serial, "77");
  EXPECT_EQ(camera->caps().model, "Nikon D800");
  EXPECT_EQ(camera->caps().size, SizePx{});
  EXPECT_EQ(camera->caps().bits, 0);
}

TEST(SerialNumbers, LeadingZerosAndBlanksMeanNothing) {
  EXPECT_TRUE(sameSerial("0000000006012345", "6012345 "));
  EXPECT_FALSE(sameSerial("6012345", "6012346"));
  for (const char* none : {"", "None", "0000", "  "}) EXPECT_TRUE(meansNothing(none)) << none;
  EXPECT_FALSE(meansNothing("1001"));
}

}  // namespace
}  // namespace patina::devices::gphoto2
