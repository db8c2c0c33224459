// SPDX-License-Identifier: GPL-3.0-or-later
// The backend usb on a relay board behind the kernel's own USB and HID drivers.
#include <gmock/gmock.h>

#include "devices/usb/usb.h"
#include "tests/guest/relay_gadget.h"
#include "tests/support/matchers.h"

namespace patina::testing {
namespace {

using namespace patina::devices;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class RelayBoardInTheKernel : public ::testing::Test {
 protected:
  void SetUp() override { board_.usb().plugIn(); }

  std::unique_ptr<Light> lampOn(int relay, const std::string& serial = "GUEST") {
    LightSpec spec;
    spec.id = "key";
    spec.backend = "usb";
    spec.address = serial;
    spec.settings = {{"relay", std::to_string(relay)}};
    return usb::makeLight(spec, "rig.toml", clock_);
  }
  // The kernel and its drivers take their time over a new device.
  Result<void> comesUp(Light& lamp) {
    Result<void> up = lamp.recover();
    for (const MonoTime end = clock_.mono() + 30s; !up && clock_.mono() < end; up = lamp.recover())
      clock_.sleepUntil(clock_.mono() + 100ms, {});
    return up;
  }

  RealClock clock_;
  RelayGadget board_{"GUEST", clock_};
};

TEST_F(RelayBoardInTheKernel, ALampFollowsAndSaysSo) {
  const auto first = lampOn(1), third = lampOn(3);
  ASSERT_THAT(comesUp(*first), IsOk());
  ASSERT_THAT(third->recover(), IsOk());
  ASSERT_THAT(third->set(1), IsOk());
  EXPECT_EQ(board_.relays(), 0b100u);
  ASSERT_THAT(first->set(1), IsOk());
  EXPECT_EQ(board_.relays(), 0b101u);
  EXPECT_EQ(third->isOn().value(), true);
  ASSERT_THAT(third->set(0), IsOk());
  EXPECT_EQ(board_.relays(), 0b001u);
  EXPECT_EQ(third->isOn().value(), false);
}

TEST_F(RelayBoardInTheKernel, ALampThatGoesIsDark) {
  {
    const auto lamp = lampOn(2);
    ASSERT_THAT(comesUp(*lamp), IsOk());
    ASSERT_THAT(lamp->set(1), IsOk());
    EXPECT_EQ(board_.relays(), 0b10u);
  }
  EXPECT_EQ(board_.relays(), 0u);
}

TEST_F(RelayBoardInTheKernel, ARelayThatSticksIsRefused) {
  const auto lamp = lampOn(1);
  ASSERT_THAT(comesUp(*lamp), IsOk());
  board_.stick(true);
  EXPECT_THAT(lamp->set(1), Fails(Errc::kRefused));
  board_.stick(false);
  EXPECT_THAT(lamp->set(1), IsOk());
}

TEST_F(RelayBoardInTheKernel, AnotherSerialIsLostWithTheOneThatIsThere) {
  ASSERT_THAT(comesUp(*lampOn(1)), IsOk());
  const auto other = lampOn(1, "OTHER")->recover();
  ASSERT_THAT(other, Fails(Errc::kLost));
  EXPECT_THAT(other.error().what, HasSubstr("GUEST"));
}

TEST_F(RelayBoardInTheKernel, UnpluggedItIsLostAndFoundAgain) {
  const auto lamp = lampOn(1);
  ASSERT_THAT(comesUp(*lamp), IsOk());
  board_.usb().unplug();
  EXPECT_THAT(lamp->set(1), Fails(Errc::kLost));
  EXPECT_THAT(lamp->recover(), Fails(Errc::kLost));
  board_.usb().plugIn();
  ASSERT_THAT(comesUp(*lamp), IsOk());
  ASSERT_THAT(lamp->set(1), IsOk());
  EXPECT_EQ(board_.relays(), 1u);
}

}  // namespace
}  // namespace patina::testing
