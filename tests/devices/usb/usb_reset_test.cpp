// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/usb_reset.h"

#include <gmock/gmock.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <atomic>

#include "tests/devices/usb/mock_node.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::MockCall;
using patina::testing::MockNode;
using ::testing::HasSubstr;

class UsbReset : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!patina::testing::underUmockdev()) GTEST_SKIP() << "not run by umockdev-wrapper";
  }
  UsbDevice device() const {
    UsbDevice d;
    d.name = "1-1";
    d.model = "Camera";
    d.bus = 1;
    d.number = 2;
    return d;
  }
  RealClock clock_;
};

TEST_F(UsbReset, AsksTheKernelOnce) {
  std::atomic<int> resets = 0;
  const auto node = MockNode::usb([&](const MockCall& call) {
    if (call.request == USBDEVFS_RESET) ++resets;
    return 0;
  });
  EXPECT_THAT(resetDevice(device(), clock_, clock_.mono() + 10s), IsOk());
  EXPECT_EQ(resets, 1);
}

TEST_F(UsbReset, SaysWhatTheKernelSaid) {
  const auto node = MockNode::usb([](const MockCall&) { return -ENODEV; });
  const auto lost = resetDevice(device(), clock_, clock_.mono() + 10s);
  ASSERT_THAT(lost, Fails(Errc::kLost));
  EXPECT_THAT(lost.error().what, HasSubstr("reset of Camera (1-1)"));
  EXPECT_THAT(lost.error().what, HasSubstr("No such device"));
}

TEST_F(UsbReset, LeavesAHangingKernelBehindAtTheDeadline) {
  const auto node = MockNode::usb([](const MockCall&) { return patina::testing::kNeverAnswer; });
  EXPECT_THAT(resetDevice(device(), clock_, clock_.mono() + 20ms), Fails(Errc::kTimeout));
}

TEST_F(UsbReset, IsLostWhenThereIsNoSuchNode) {
  UsbDevice gone = device();
  gone.number = 99;
  EXPECT_THAT(resetDevice(gone, clock_, clock_.mono() + 10s), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::usb
