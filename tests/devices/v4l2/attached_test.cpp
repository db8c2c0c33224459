// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/attached.h"

#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Attached : public V4l2Fixture {
 protected:
  SimulatedCamera second{clock};
  void SetUp() override {
    V4l2Fixture::SetUp();
    second.serial = "SIM0002";
  }
};

TEST_F(Attached, NodesHaveTheirSerialAndTheirStableNames) {
  testbed().plugIn(webcam, 4, 2);
  const auto nodes = v4l2::attachedNodes();
  ASSERT_EQ(nodes.size(), 1u);
  EXPECT_EQ(nodes[0].path, "/dev/video4");
  EXPECT_EQ(nodes[0].model, "Simulated Webcam");
  EXPECT_EQ(nodes[0].serial, "SIM0001");
  EXPECT_THAT(nodes[0].stable, ElementsAre(V4l2Testbed::byId(webcam), V4l2Testbed::byPath(2)));
}

TEST_F(Attached, TheSerialFindsItsCameraUnderAnyNumber) {
  testbed().plugIn(second, 0, 1);
  testbed().plugIn(webcam, 1, 2);
  EXPECT_EQ(v4l2::locate({"", "SIM0001"}, "v4l2")->path, "/dev/video1");
  testbed().pullOut(webcam);
  testbed().pullOut(second);
  testbed().plugIn(webcam, 0, 1);
  testbed().plugIn(second, 1, 2);
  EXPECT_EQ(v4l2::locate({"", "SIM0001"}, "v4l2")->path, "/dev/video0");
}

TEST_F(Attached, ALinkFindsItsCamera) {
  testbed().plugIn(second, 0, 1);
  testbed().plugIn(webcam, 1, 2);
  EXPECT_EQ(v4l2::locate({V4l2Testbed::byId(webcam), ""}, "v4l2")->path, "/dev/video1");
  EXPECT_EQ(v4l2::locate({V4l2Testbed::byPath(1), ""}, "v4l2")->path, "/dev/video0");
}

TEST_F(Attached, ANumberIsNoNameWhereThereAreSeveral) {
  testbed().plugIn(webcam, 0, 1);
  EXPECT_THAT(v4l2::locate({"/dev/video0", ""}, "v4l2"), IsOk());
  testbed().plugIn(second, 1, 2);
  const auto refused = v4l2::locate({"/dev/video0", ""}, "v4l2");
  ASSERT_THAT(refused, Fails(Errc::kRefused));
  EXPECT_THAT(refused.error().what, HasSubstr("serial SIM0001"));
  EXPECT_THAT(refused.error().what, HasSubstr(V4l2Testbed::byId(second)));
}

TEST_F(Attached, WithoutANameTheOnlyOneIsMeantAndNeverOneOfTwo) {
  EXPECT_THAT(v4l2::locate({"", ""}, "v4l2"), Fails(Errc::kLost));
  testbed().plugIn(webcam, 0, 1);
  EXPECT_THAT(v4l2::locate({"", ""}, "v4l2"), IsOk());
  testbed().plugIn(second, 1, 2);
  EXPECT_THAT(v4l2::locate({"", ""}, "v4l2"), Fails(Errc::kRefused));
}

TEST_F(Attached, TwoCamerasOfOneSerialCannotBeToldApartByIt) {
  second.serial = "SIM0001";
  second.model = "Another";
  testbed().plugIn(webcam, 0, 1);
  // Its link below by-id is taken by the first: as udev, which keeps one of them.
  testbed().plugIn(second, 1, 2);
  EXPECT_THAT(v4l2::locate({"", "SIM0001"}, "v4l2"), Fails(Errc::kRefused));
  EXPECT_EQ(v4l2::locate({V4l2Testbed::byPath(2), "SIM0001"}, "v4l2")->path, "/dev/video1");
}

TEST_F(Attached, ACameraOfAnotherSerialBehindTheLinkIsNotIt) {
  testbed().plugIn(second, 0, 1);
  const auto other = v4l2::locate({V4l2Testbed::byPath(1), "SIM0001"}, "v4l2");
  ASSERT_THAT(other, Fails(Errc::kLost));
  EXPECT_THAT(other.error().what, HasSubstr("serial SIM0002"));
}

TEST_F(Attached, NodesThatDoNotCaptureAreNoCameras) {
  second.device_caps = V4L2_CAP_VIDEO_OUTPUT | V4L2_CAP_STREAMING;
  testbed().plugIn(second, 0, 1);
  testbed().plugIn(webcam, 1, 2);
  EXPECT_EQ(v4l2::locate({"", ""}, "v4l2")->path, "/dev/video1");
}

}  // namespace
}  // namespace patina::testing
