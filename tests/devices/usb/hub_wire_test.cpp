// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hub_wire.h"

#include <gmock/gmock.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>

#include <algorithm>

#include "devices/usb/hub_port.h"
#include "tests/devices/usb/mock_node.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::MockCall;
using patina::testing::MockNode;
using ::testing::ElementsAre;

class HubWireOnAHub : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!patina::testing::underUmockdev()) GTEST_SKIP() << "not run by umockdev-wrapper";
  }
  // A hub of four ports, each with a switch of its own.
  int answer(const MockCall& call) {
    if (call.request != USBDEVFS_CONTROL) return -ENOTTY;
    const int request = call.setup[1], port = call.setup[4];
    const std::array<std::uint8_t, 9> descriptor{9, 0x29, 4, 1, 0, 50, 0, 0, 0xff};
    switch (request) {
      case 6:
        std::copy_n(descriptor.begin(), std::min<std::size_t>(9, call.bytes.size()),
                    call.bytes.begin());
        return 9;
      case 0:
        std::ranges::fill(call.bytes, std::uint8_t{0});
        call.bytes[1] = (powered_ >> port & 1) != 0 ? 1 : 0;
        return 4;
      case 1:
        powered_ &= ~(1u << port);
        return 0;
      case 3:
        powered_ |= 1u << port;
        return 0;
      default:
        return -EPIPE;
    }
  }
  UsbDevice hub() { return attached().at(0); }
  unsigned powered_ = 0xff;
  MockNode node_ = MockNode::usb([this](const MockCall& call) { return answer(call); });
  std::unique_ptr<HubWire> wire_ = makeUsbfsWire();
};

TEST_F(HubWireOnAHub, CarriesRequestsAndAnswers) {
  EXPECT_EQ(hub().model, "USB2.0 Hub");
  const auto descriptor = wire_->control(hub(), {0xa0, 6, 0x2900, 0, 15});
  ASSERT_THAT(descriptor, IsOk());
  EXPECT_EQ(descriptor->size(), 9u);
  EXPECT_THAT(askSwitching(hub(), *wire_), IsOk());
}

TEST_F(HubWireOnAHub, SwitchesAPortAndReadsItBack) {
  VirtualClock clock(utcFromNs(0));
  ASSERT_THAT(setPortPower({"1-1", 3}, false, *wire_, clock), IsOk());
  EXPECT_EQ(powered_, 0xf7u);
  ASSERT_THAT(setPortPower({"1-1", 3}, true, *wire_, clock), IsOk());
  EXPECT_EQ(powered_, 0xffu);
}

TEST_F(HubWireOnAHub, TellsARefusedRequestFromAMissingHub) {
  EXPECT_THAT(wire_->control(hub(), {0xa0, 77, 0, 0, 0}), Fails(Errc::kRefused));
  UsbDevice gone = hub();
  gone.number = 77;
  EXPECT_THAT(wire_->control(gone, {0xa0, 6, 0x2900, 0, 15}), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::usb
