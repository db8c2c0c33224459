// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/v4l2/node.h"

#include "tests/devices/v4l2/attached_camera.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using ::testing::HasSubstr;

class Node : public V4l2Fixture {
 protected:
  // What an ioctl that fails so is taken for.
  Error errorOf(int number) {
    webcam.fails = {{VIDIOC_QUERYCAP, number}};
    const auto node = v4l2::Node::open("/dev/video0", "v4l2 'cam0'");
    v4l2_capability caps{};
    const auto done = node->call(VIDIOC_QUERYCAP, &caps, "ask");
    return done ? Error{Errc::kUnsupported, "no error"} : done.error();
  }
};

TEST_F(Node, ErrnoBecomesWhatTheCallerShouldDo) {
  testbed().plugIn(webcam, 0, 1);
  EXPECT_EQ(errorOf(ENODEV).code, Errc::kLost);
  EXPECT_EQ(errorOf(EIO).code, Errc::kLost);
  EXPECT_EQ(errorOf(EBUSY).code, Errc::kBusy);
  EXPECT_EQ(errorOf(ETIMEDOUT).code, Errc::kTimeout);
  EXPECT_EQ(errorOf(EINVAL).code, Errc::kRefused);
  EXPECT_EQ(errorOf(EACCES).code, Errc::kRefused);
  EXPECT_THAT(errorOf(EACCES).what, HasSubstr("group 'video'"));
  EXPECT_THAT(errorOf(ENODEV).what, HasSubstr("v4l2 'cam0': /dev/video0: ask"));
}

TEST_F(Node, OneThatIsNotThereIsLost) {
  EXPECT_THAT(v4l2::Node::open("/dev/video7", "v4l2 'cam0'"), Fails(Errc::kLost));
}

TEST_F(Node, ClosesItsDescriptorOnceAfterAMove) {
  testbed().plugIn(webcam, 0, 1);
  auto first = v4l2::Node::open("/dev/video0", "a");
  auto second = v4l2::Node::open("/dev/video0", "b");
  const int fd = second->fd();
  *first = std::move(*second);
  EXPECT_EQ(first->fd(), fd);
  EXPECT_EQ(first->who(), "b");
  v4l2_capability caps{};
  EXPECT_EQ(first->ask(VIDIOC_QUERYCAP, &caps), 0);
}

}  // namespace
}  // namespace patina::testing
