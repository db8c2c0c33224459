// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/libcamera/camera_settings.h"

#include <gmock/gmock.h>

#include "devices/config_file.h"

namespace patina::devices::libcamera {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;

CameraSpec specOf(std::map<std::string, std::string> values) {
  CameraSpec spec;
  spec.id = "cam0";
  spec.serial = "/base/imx477";
  spec.settings = std::move(values);
  return spec;
}

std::string problemWith(const CameraSpec& spec) {
  try {
    readCameraSettings(spec, "rig.toml");
  } catch (const ConfigError& problem) {
    return problem.what();
  }
  return "none";
}

TEST(LibcameraSettings, EveryOneIsRead) {
  const CameraSettings s = readCameraSettings(specOf({{"format", "dng"},
                                                      {"width_px", "4056"},
                                                      {"height_px", "3040"},
                                                      {"base_iso", "40"},
                                                      {"red_gain", "2.5"},
                                                      {"blue_gain", "1.5"},
                                                      {"focus_dioptres", "0"},
                                                      {"black_level", "256"},
                                                      {"exposure_min", "1/20000"},
                                                      {"exposure_max", "20s"},
                                                      {"cycle", "5s"},
                                                      {"warm_up_frames", "0"}}),
                                              "rig.toml");
  EXPECT_EQ(s.camera_id, "/base/imx477");
  EXPECT_EQ(s.wish, Wish::kDng);
  EXPECT_EQ(s.size, (SizePx{4056, 3040}));
  EXPECT_EQ(s.base_iso, Iso{40});
  EXPECT_EQ(s.colour_gains, (std::array<double, 2>{2.5, 1.5}));
  EXPECT_EQ(s.focus_dioptres, 0.0);
  EXPECT_EQ(s.black_level, 256);
  EXPECT_EQ(s.exposure_min, 50us);
  EXPECT_EQ(s.exposure_max, 20s);
  EXPECT_EQ(s.cycle, 5s);
  EXPECT_EQ(s.warm_up_frames, 0);
}

TEST(LibcameraSettings, LeftOutTheLensIsNotMovedAndTheLargestSizeIsTaken) {
  const CameraSettings s = readCameraSettings(specOf({}), "rig.toml");
  EXPECT_FALSE(s.focus_dioptres);
  EXPECT_FALSE(s.fixed_exposure);
  EXPECT_EQ(s.size, SizePx{});
  EXPECT_EQ(s.wish, Wish::kPng);
}

TEST(LibcameraSettings, MistakesNameTheFileTheCameraAndTheKey) {
  CameraSpec nameless = specOf({});
  nameless.serial.clear();
  EXPECT_THAT(problemWith(nameless), HasSubstr("camera 'cam0': serial"));
  const std::pair<std::string, std::string> wrong[] = {
      {"format", "tiff"},      {"width_px", "640"},     {"base_iso", "0"},
      {"red_gain", "0"},       {"exposure_min", "20s"}, {"fixed_exposure", "0s"},
      {"warm_up_frames", "x"}, {"cycle", "0s"},         {"exposure_max", "1801s"},
      {"colour", "1"}};
  for (const auto& [key, value] : wrong) {
    const std::string problem = problemWith(specOf({{key, value}}));
    EXPECT_THAT(problem, HasSubstr("rig.toml")) << key;
    EXPECT_THAT(problem, HasSubstr("cam0")) << key;
    EXPECT_THAT(problem, HasSubstr(key)) << key;
  }
}

}  // namespace
}  // namespace patina::devices::libcamera
