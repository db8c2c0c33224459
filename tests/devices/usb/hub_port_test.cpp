// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hub_port.h"

#include <gmock/gmock.h>

#include "tests/devices/usb/fake_hub.h"
#include "tests/devices/usb/usb_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using patina::testing::Fails;
using patina::testing::FakeHubs;
using patina::testing::IsOk;
using patina::testing::UsbTree;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class HubPorts : public ::testing::Test {
 protected:
  HubPorts() {
    tree_.add({.name = "usb1", .number = 1, .hub = true});
    tree_.add({.name = "1-1", .number = 2, .model = "Hub", .hub = true});
    tree_.add({.name = "1-1.4", .number = 3, .serial = "123", .model = "Camera"});
    tree_.add({.name = "1-1.2", .number = 4, .model = "Disk"});
  }
  UsbTree tree_;
  FakeHubs hubs_;
  VirtualClock clock_{utcFromNs(0)};
};

TEST_F(HubPorts, FollowFromTheNameOfTheDevice) {
  EXPECT_EQ(portOf("1-1.4"), (HubPort{"1-1", 4}));
  EXPECT_EQ(portOf("2-13"), (HubPort{"usb2", 13}));
  EXPECT_EQ(portOf("1-1.4.2"), (HubPort{"1-1.4", 2}));
  EXPECT_EQ(portOf("usb1"), std::nullopt);
}

TEST_F(HubPorts, SwitchAsTheirDescriptorSays) {
  const auto with = [](int characteristics) {
    return switchingOf({9, 0x29, 4, static_cast<std::uint8_t>(characteristics), 0});
  };
  EXPECT_EQ(*with(0), PowerSwitching::kAllPorts);
  EXPECT_EQ(*with(1 | 0x80), PowerSwitching::kEachPort);
  EXPECT_EQ(*with(2), PowerSwitching::kNone);
  EXPECT_THAT(switchingOf({9, 0x21, 4, 1, 0}), Fails(Errc::kCorrupt));
  EXPECT_THAT(switchingOf({9, 0x29}), Fails(Errc::kCorrupt));
}

TEST_F(HubPorts, NameWhatElseWouldDrop) {
  const HubPort port{"1-1", 4};
  EXPECT_TRUE(alsoDrops(port, PowerSwitching::kEachPort, "1-1.4", tree_.root()).empty());
  EXPECT_THAT(alsoDrops(port, PowerSwitching::kAllPorts, "1-1.4", tree_.root()),
              ElementsAre(HasSubstr("Disk")));
  // Behind the port itself.
  EXPECT_THAT(alsoDrops({"usb1", 1}, PowerSwitching::kEachPort, "1-1", tree_.root()),
              ElementsAre(HasSubstr("Disk"), HasSubstr("Camera")));
}

TEST_F(HubPorts, HaveACompanionWhereTheConnectorHasTwoSpeeds) {
  EXPECT_EQ(companionOf({"1-1", 4}, tree_.root()), std::nullopt);
  tree_.pair("1-1", "2-1", 4);
  tree_.pair("usb1", "usb2", 3);
  EXPECT_EQ(companionOf({"1-1", 4}, tree_.root()), (HubPort{"2-1", 4}));
  EXPECT_EQ(companionOf({"usb2", 3}, tree_.root()), (HubPort{"usb1", 3}));
}

TEST_F(HubPorts, AreReadBackAfterTheyWereTold) {
  ASSERT_THAT(setPortPower({"1-1", 4}, false, hubs_, clock_, tree_.root()), IsOk());
  ASSERT_THAT(setPortPower({"1-1", 4}, true, hubs_, clock_, tree_.root()), IsOk());
  EXPECT_THAT(hubs_.did, ElementsAre("1-1 port 4 off", "1-1 port 4 on"));
}

TEST_F(HubPorts, AHubThatOnlyPretendsIsUnsupported) {
  hubs_.pretends = true;
  const auto cut = setPortPower({"1-1", 4}, false, hubs_, clock_, tree_.root());
  ASSERT_THAT(cut, Fails(Errc::kUnsupported));
  EXPECT_THAT(cut.error().what, HasSubstr("no switch for that port"));
}

TEST_F(HubPorts, PowerThatDoesNotComeBackIsSaid) {
  ASSERT_THAT(setPortPower({"1-1", 4}, false, hubs_, clock_, tree_.root()), IsOk());
  hubs_.dead = true;
  EXPECT_THAT(setPortPower({"1-1", 4}, true, hubs_, clock_, tree_.root()),
              Fails(Errc::kUnsupported));
}

TEST_F(HubPorts, AHubThatIsGoneOrSilentIsSaid) {
  EXPECT_THAT(setPortPower({"1-9", 4}, false, hubs_, clock_, tree_.root()), Fails(Errc::kLost));
  hubs_.silent = true;
  EXPECT_THAT(setPortPower({"1-1", 4}, false, hubs_, clock_, tree_.root()), Fails(Errc::kTimeout));
}

TEST_F(HubPorts, SuperspeedHubsAreAskedAndReadInTheirOwnWay) {
  tree_.add({.name = "2-1", .number = 2, .hub = true, .speed_mbps = 5000});
  const auto all = attached(tree_.root());
  const auto hub = std::ranges::find(all, "2-1", &UsbDevice::name);
  ASSERT_NE(hub, all.end());
  EXPECT_EQ(*askSwitching(*hub, hubs_), PowerSwitching::kEachPort);
  EXPECT_THAT(setPortPower({"2-1", 4}, true, hubs_, clock_, tree_.root()), IsOk());
}

}  // namespace
}  // namespace patina::devices::usb
