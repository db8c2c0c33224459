// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/controls.h"

#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Controls : public V4l2Fixture {
 protected:
  void SetUp() override {
    V4l2Fixture::SetUp();
    if (!IsSkipped()) testbed().plugIn(webcam, 0, 1);
  }
  v4l2::Controls& with(std::map<std::string, std::string> settings) {
    const auto camera = spec(std::move(settings));
    settings_ = v4l2::readCameraSettings(camera, "rig.toml");
    node_.emplace(std::move(*v4l2::Node::open("/dev/video0", "v4l2 'cam0'")));
    return controls_.emplace(*node_, settings_);
  }
  const v4l2::Node& node() { return *node_; }
  std::int32_t value(std::uint32_t id) { return webcam.controls.value(id, -999); }

 private:
  v4l2::CameraSettings settings_;
  std::optional<v4l2::Node> node_;
  std::optional<v4l2::Controls> controls_;
};

TEST_F(Controls, EveryAutomaticOneIsTurnedOff) {
  auto& controls = with({});
  EXPECT_THAT(
      v4l2::automaticOnes(node()),
      ElementsAre("White Balance, Automatic", "Focus, Automatic Continuous", "Auto Exposure"));
  ASSERT_THAT(controls.applySettings(), IsOk());
  EXPECT_TRUE(v4l2::automaticOnes(node()).empty());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_MANUAL);
}

TEST_F(Controls, ThoseOfTheRigAreSetAndTheOthersGoToTheirDefault) {
  webcam.controls.at(V4L2_CID_BRIGHTNESS).value = 33;  // left behind by somebody
  auto& controls =
      with({{"gain", "70"}, {"white_balance", "5200"}, {"focus", "35"}, {"power_line", "50Hz"}});
  ASSERT_THAT(controls.applySettings(), IsOk());
  EXPECT_EQ(value(V4L2_CID_GAIN), 70);
  EXPECT_EQ(value(V4L2_CID_WHITE_BALANCE_TEMPERATURE), 5200);
  EXPECT_EQ(value(V4L2_CID_FOCUS_ABSOLUTE), 35);
  EXPECT_EQ(value(V4L2_CID_POWER_LINE_FREQUENCY), 1);
  EXPECT_EQ(value(V4L2_CID_BRIGHTNESS), 0);
  EXPECT_THAT(controls.verify(), IsOk());
}

TEST_F(Controls, AnAutomaticMainsFrequencyIsNoDefault) {
  auto& mains = webcam.controls.at(V4L2_CID_POWER_LINE_FREQUENCY);
  mains.menu[3] = "Auto";
  mains.most = mains.fallback = mains.value = 3;
  ASSERT_THAT(with({}).applySettings(), IsOk());
  EXPECT_EQ(value(V4L2_CID_POWER_LINE_FREQUENCY), 0);
}

TEST_F(Controls, AValueOffTheStepsIsRefusedWithTheRange) {
  const auto done = with({{"focus", "33"}}).applySettings();
  ASSERT_THAT(done, Fails(Errc::kRefused));
  EXPECT_THAT(done.error().what, HasSubstr("0 to 250 in steps of 5"));
}

TEST_F(Controls, ASettingThatTheCameraHasNoControlForIsRefused) {
  const auto done = with({{"zoom", "2"}}).applySettings();
  ASSERT_THAT(done, Fails(Errc::kRefused));
  EXPECT_THAT(done.error().what, HasSubstr("no control for settings.zoom"));
}

TEST_F(Controls, AnAutomaticOneThatStaysOnIsRefused) {
  webcam.controls.at(V4L2_CID_AUTO_WHITE_BALANCE).keeps_old_value = true;
  const auto done = with({}).applySettings();
  ASSERT_THAT(done, Fails(Errc::kRefused));
  EXPECT_THAT(done.error().what, HasSubstr("'White Balance, Automatic': asked for 0"));
}

TEST_F(Controls, AMenuWithoutManualExposureTakesShutterPriorityOrIsRefused) {
  auto& automatic = webcam.controls.at(V4L2_CID_EXPOSURE_AUTO);
  automatic.menu = {{2, "Shutter Priority Mode"}, {3, "Aperture Priority Mode"}};
  webcam.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).needs_value = 2;
  ASSERT_THAT(with({}).applySettings(), IsOk());
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_AUTO), V4L2_EXPOSURE_SHUTTER_PRIORITY);
  automatic.menu.erase(2);
  EXPECT_THAT(with({}).applySettings(), Fails(Errc::kRefused));
}

TEST_F(Controls, ExposureStepsThatAreCoarseAreRefusedBeyondOnePerCent) {
  webcam.controls.at(V4L2_CID_EXPOSURE_ABSOLUTE).step = 39;  // 1, 40, 79, 118 ...
  auto& controls = with({});
  ASSERT_THAT(controls.applySettings(), IsOk());
  EXPECT_EQ(controls.applyExposure({7950us})->time, 7900us);
  const auto refused = controls.applyExposure({10ms});
  ASSERT_THAT(refused, Fails(Errc::kRefused));
  EXPECT_THAT(refused.error().what, HasSubstr(formatExposure(7900us)));
  EXPECT_THAT(refused.error().what, HasSubstr(formatExposure(11'800us)));
  EXPECT_EQ(value(V4L2_CID_EXPOSURE_ABSOLUTE), 79);
}

TEST_F(Controls, IsoIsOneOfTheCamerasOwnOrComesBackAsAskedWithoutAControl) {
  auto& controls = with({});
  ASSERT_THAT(controls.applySettings(), IsOk());
  EXPECT_EQ(controls.applyExposure({10ms, Iso{123}})->iso, Iso{123});
  SimulatedControl iso{V4L2_CID_ISO_SENSITIVITY, V4L2_CTRL_TYPE_INTEGER_MENU, "ISO", 0, 2, 1};
  iso.numbers = {{0, 100'000}, {1, 200'000}, {2, 400'000}};
  webcam.controls.add(iso);
  EXPECT_EQ(controls.applyExposure({10ms, Iso{200}})->iso, Iso{200});
  EXPECT_EQ(value(V4L2_CID_ISO_SENSITIVITY), 1);
  const auto refused = controls.applyExposure({10ms, Iso{300}});
  ASSERT_THAT(refused, Fails(Errc::kRefused));
  EXPECT_THAT(refused.error().what, HasSubstr("100, 200, 400"));
}

}  // namespace
}  // namespace patina::testing
