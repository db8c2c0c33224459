// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/controls.h"
#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using ::testing::ElementsAre;

class ControlFacts : public V4l2Fixture {
 protected:
  v4l2::Node node() {
    testbed().plugIn(webcam, 0, 1);
    return std::move(*v4l2::Node::open("/dev/video0", "v4l2 'cam0'"));
  }
};

TEST_F(ControlFacts, AreThoseOfTheDriver) {
  const v4l2::Node opened = node();
  EXPECT_EQ(v4l2::allControls(opened).size(), 9u);
  const auto focus = v4l2::controlFacts(opened, V4L2_CID_FOCUS_ABSOLUTE);
  ASSERT_TRUE(focus);
  EXPECT_EQ(focus->name, "Focus, Absolute");
  EXPECT_EQ(v4l2::allowed(*focus), "0 to 250 in steps of 5");
  EXPECT_TRUE(focus->inactive);  // its automatic is on
  EXPECT_EQ(v4l2::allowed(*v4l2::controlFacts(opened, V4L2_CID_EXPOSURE_AUTO)),
            "1 (Manual Mode), 3 (Aperture Priority Mode)");
  EXPECT_FALSE(v4l2::controlFacts(opened, V4L2_CID_ZOOM_ABSOLUTE));
}

TEST_F(ControlFacts, ADisabledControlIsNotThere) {
  webcam.controls.at(V4L2_CID_GAIN).flags = V4L2_CTRL_FLAG_DISABLED;
  EXPECT_FALSE(v4l2::controlFacts(node(), V4L2_CID_GAIN));
}

TEST_F(ControlFacts, MenusOfNumbersKeepTheirValues) {
  SimulatedControl iso{V4L2_CID_ISO_SENSITIVITY, V4L2_CTRL_TYPE_INTEGER_MENU, "ISO", 0, 3, 1};
  iso.numbers = {{0, 100'000}, {3, 400'000}};
  webcam.controls.add(iso);
  const auto facts = v4l2::controlFacts(node(), V4L2_CID_ISO_SENSITIVITY);
  ASSERT_TRUE(facts);
  EXPECT_THAT(facts->numbers, ElementsAre(std::pair(0, std::int64_t{100'000}),
                                          std::pair(3, std::int64_t{400'000})));
}

TEST_F(ControlFacts, AutomaticOnesThatAreOnAreNamed) {
  EXPECT_THAT(
      v4l2::automaticOnes(node()),
      ElementsAre("White Balance, Automatic", "Focus, Automatic Continuous", "Auto Exposure"));
}

}  // namespace
}  // namespace patina::testing
