// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/camera_settings.h"

#include <gmock/gmock.h>
#include <linux/videodev2.h>

#include "devices/config_file.h"
#include "devices/v4l2/v4l2.h"

namespace patina::devices::v4l2 {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

CameraSettings read(std::map<std::string, std::string> settings) {
  CameraSpec spec;
  spec.id = "cam0";
  spec.settings = std::move(settings);
  return readCameraSettings(spec, "rig.toml");
}

std::string problemOf(std::map<std::string, std::string> settings) {
  try {
    read(std::move(settings));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "none";
}

TEST(CameraSettings, WithoutAnyAreAPlainWebcams) {
  const CameraSettings s = read({});
  EXPECT_STREQ(s.format->name, "yuyv");
  EXPECT_EQ(s.size, (SizePx{0, 0}));
  EXPECT_EQ(s.exposure_min, 100us);
  EXPECT_TRUE(s.controls.empty());
  EXPECT_TRUE(s.stream_between);
}

TEST(CameraSettings, ControlsAreNumbersOrTheirWords) {
  const CameraSettings s =
      read({{"gain", "12"}, {"power_line", "50Hz"}, {"brightness", "-3"}, {"size", "640x480"}});
  EXPECT_EQ(s.controls.at(V4L2_CID_GAIN), 12);
  EXPECT_EQ(s.controls.at(V4L2_CID_POWER_LINE_FREQUENCY), 1);
  EXPECT_EQ(s.controls.at(V4L2_CID_BRIGHTNESS), -3);
  EXPECT_EQ(s.controls.size(), 3u);
  EXPECT_EQ(s.size, (SizePx{640, 480}));
}

TEST(CameraSettings, AFixedExposureIsTheOnlyOne) {
  const CameraSettings s = read({{"fixed_exposure", "1/30"}});
  EXPECT_EQ(s.exposure_min, parseExposure("1/30"));
  EXPECT_EQ(s.exposure_max, parseExposure("1/30"));
}

TEST(CameraSettings, MistakesNameTheKeyAndWhatIsAllowed) {
  EXPECT_THAT(problemOf({{"format", "h264"}}), HasSubstr("mjpeg"));
  EXPECT_THAT(problemOf({{"device", "/dev/ttyUSB0"}}), HasSubstr("/dev/v4l/by-id"));
  EXPECT_THAT(problemOf({{"power_line", "55Hz"}}), HasSubstr("off, 50Hz, 60Hz"));
  EXPECT_THAT(problemOf({{"size", "big"}}), HasSubstr("size"));
  EXPECT_THAT(problemOf({{"exposure_min", "3s"}}), HasSubstr("above exposure_max"));
  EXPECT_THAT(problemOf({{"iso", "100"}}), HasSubstr("unknown"));
  EXPECT_THAT(problemOf({{"gain", "1.5"}}), HasSubstr("whole number"));
}

TEST(MakeCamera, KnowsItsCapsWithoutACamera) {
  CameraSpec spec;
  spec.id = "cam7";
  spec.serial = "123";
  spec.settings = {{"format", "rggb12p"}, {"size", "4000x3000"}, {"exposure_max", "1s"}};
  RealClock clock;
  const auto camera = makeCamera(spec, "rig.toml", clock);
  EXPECT_EQ(camera->caps().id, "cam7");
  EXPECT_EQ(camera->caps().size, (SizePx{4000, 3000}));
  EXPECT_EQ(camera->caps().bits, 12);
  EXPECT_EQ(camera->caps().extensions, std::vector<std::string>{"dng"});
  EXPECT_EQ(camera->caps().exposure_max, 1s);
}

}  // namespace
}  // namespace patina::devices::v4l2
