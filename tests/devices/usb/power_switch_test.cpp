// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/power_switch.h"

#include <gmock/gmock.h>

#include "tests/contract/stub_devices.h"
#include "tests/devices/usb/fake_hub.h"
#include "tests/devices/usb/usb_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using namespace std::chrono_literals;
using patina::testing::Fails;
using patina::testing::FakeHubs;
using patina::testing::IsOk;
using patina::testing::UsbTree;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class HubPower : public ::testing::Test {
 protected:
  HubPower() {
    tree_.add({.name = "1-1", .number = 2, .model = "Hub", .hub = true});
    tree_.add({.name = "1-1.4", .number = 3, .serial = "123", .model = "Camera"});
    tree_.add({.name = "1-1.2", .number = 4, .model = "Disk"});
  }
  UsbTree tree_;
  FakeHubs hubs_;
  VirtualClock clock_{utcFromNs(0)};
  std::unique_ptr<PowerSwitch> power_ =
      makeHubPower({0x04a9, 0, "123"}, hubs_, clock_, tree_.root());
};

TEST_F(HubPower, IsOffForAsLongAsAskedAndComesBack) {
  const MonoTime before = clock_.mono();
  ASSERT_THAT(cyclePower(*power_, 5s, clock_), IsOk());
  EXPECT_GE(clock_.mono() - before, 5s);
  EXPECT_THAT(hubs_.did, ElementsAre("1-1 port 4 off", "1-1 port 4 on"));
  EXPECT_TRUE(hubs_.off.empty());
}

TEST_F(HubPower, CutsBothHalvesOfAConnector) {
  tree_.add({.name = "2-1", .number = 2, .hub = true, .speed_mbps = 5000});
  tree_.pair("1-1", "2-1", 4);
  ASSERT_THAT(cyclePower(*power_, 1s, clock_), IsOk());
  EXPECT_THAT(hubs_.did,
              ElementsAre("1-1 port 4 off", "2-1 port 4 off", "1-1 port 4 on", "2-1 port 4 on"));
}

TEST_F(HubPower, KnowsTheLastPortOfADeviceThatIsGone) {
  ASSERT_THAT(power_->alsoDrops(), IsOk());
  tree_.remove("1-1.4");
  EXPECT_THAT(cyclePower(*power_, 1s, clock_), IsOk());
  EXPECT_THAT(hubs_.did, ElementsAre("1-1 port 4 off", "1-1 port 4 on"));
  auto stranger = makeHubPower({0x04a9, 0, "999"}, hubs_, clock_, tree_.root());
  EXPECT_THAT(cyclePower(*stranger, 1s, clock_), Fails(Errc::kLost));
}

TEST_F(HubPower, OfAHubWithOneSwitchForAllIsNotCutAndSaysWhoWouldDrop) {
  hubs_.characteristics = 0;
  const auto drops = power_->alsoDrops();
  ASSERT_THAT(drops, IsOk());
  EXPECT_THAT(*drops, ElementsAre(HasSubstr("Disk")));
  const auto cut = power_->cut();
  ASSERT_THAT(cut, Fails(Errc::kUnsupported));
  EXPECT_THAT(cut.error().what, HasSubstr("switches all its ports together"));
  EXPECT_TRUE(hubs_.did.empty());
}

TEST_F(HubPower, OfAHubWithoutASwitchIsUnsupported) {
  hubs_.characteristics = 2;
  EXPECT_THAT(power_->alsoDrops(), Fails(Errc::kUnsupported));
  EXPECT_THAT(power_->cut(), Fails(Errc::kUnsupported));
}

TEST_F(HubPower, ComesBackAlsoWhenCuttingFailedHalfWay) {
  hubs_.pretends = true;
  EXPECT_THAT(cyclePower(*power_, 1s, clock_), Fails(Errc::kUnsupported));
  EXPECT_EQ(hubs_.did.back(), "1-1 port 4 on");
}

TEST(RelayPower, CutsWithTheRelayOnAndGivesPowerWithItOff) {
  VirtualClock clock(utcFromNs(0));
  const auto relay = patina::testing::makeStubLight("cam_power");
  const auto power = makeRelayPower(*relay);
  ASSERT_THAT(power->cut(), IsOk());
  EXPECT_EQ(*relay->isOn(), std::optional<bool>(true));
  ASSERT_THAT(cyclePower(*power, 3s, clock), IsOk());
  EXPECT_EQ(*relay->isOn(), std::optional<bool>(false));
  EXPECT_TRUE(power->alsoDrops()->empty());
}

}  // namespace
}  // namespace patina::devices::usb
