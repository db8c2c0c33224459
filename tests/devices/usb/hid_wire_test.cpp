// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hid_wire.h"

#include <gmock/gmock.h>
#include <linux/hidraw.h>
#include <sys/ioctl.h>

#include <algorithm>

#include "devices/usb/hid_relay.h"
#include "tests/devices/usb/mock_node.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::MockCall;
using patina::testing::MockNode;

class HidWireOnABoard : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!patina::testing::underUmockdev()) GTEST_SKIP() << "not run by umockdev-wrapper";
  }
  int answer(const MockCall& call) {
    if (gone_) return -ENODEV;
    if (call.request == HIDIOCSFEATURE(9)) {
      const unsigned bit = 1u << (call.bytes[2] - 1);
      state_ = call.bytes[1] == 0xff ? state_ | bit : state_ & ~bit;
      return 9;
    }
    if (call.request != HIDIOCGFEATURE(9)) return -ENOTTY;
    std::ranges::copy(std::string("\0HURTM\0\0", 8), call.bytes.begin());
    call.bytes[8] = static_cast<std::uint8_t>(state_);
    return short_ ? 3 : 9;
  }
  bool gone_ = false, short_ = false;
  unsigned state_ = 0;
  MockNode node_ = MockNode::hidraw([this](const MockCall& call) { return answer(call); });
};

TEST_F(HidWireOnABoard, WritesAndReadsFeatureReportsOfNumber0) {
  const auto wire = openHidraw("/dev/hidraw0");
  ASSERT_THAT(wire, IsOk());
  ASSERT_THAT((*wire)->setFeature(relayCommand(3, true)), IsOk());
  EXPECT_EQ(state_, 4u);
  const auto report = (*wire)->feature();
  ASSERT_THAT(report, IsOk());
  const auto state = decodeRelays(*report);
  ASSERT_THAT(state, IsOk());
  EXPECT_EQ(state->serial, "HURTM");
  EXPECT_EQ(state->relays, 4u);
}

TEST_F(HidWireOnABoard, IsLostWhenUnpluggedAndDistrustsAShortReport) {
  EXPECT_THAT(openHidraw("/dev/hidraw9"), Fails(Errc::kLost));
  const auto wire = openHidraw("/dev/hidraw0");
  ASSERT_THAT(wire, IsOk());
  short_ = true;
  EXPECT_THAT((*wire)->feature(), Fails(Errc::kCorrupt));
  gone_ = true;
  EXPECT_THAT((*wire)->feature(), Fails(Errc::kLost));
  EXPECT_THAT((*wire)->setFeature({}), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::usb
