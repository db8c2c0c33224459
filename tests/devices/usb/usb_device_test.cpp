// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/usb_device.h"

#include <gmock/gmock.h>

#include "tests/devices/usb/usb_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::UsbTree;
using ::testing::HasSubstr;

class UsbDevices : public ::testing::Test {
 protected:
  UsbDevices() {
    tree_.add({.name = "usb1",
               .vendor = 0x1d6b,
               .product = 2,
               .number = 1,
               .model = "root",
               .hub = true});
    tree_.add({.name = "1-1.4", .number = 14, .serial = "123", .model = "EOS 90D"});
    tree_.add({.name = "1-2", .number = 15, .serial = "456", .model = "EOS 90D"});
  }
  UsbTree tree_;
};

TEST_F(UsbDevices, AreTheDevicesAndNotTheirInterfaces) {
  const auto all = attached(tree_.root());
  ASSERT_EQ(all.size(), 3u);
  EXPECT_EQ(all[0].name, "1-1.4");
  EXPECT_EQ(all[0].vendor, 0x04a9);
  EXPECT_EQ(all[0].node(), "dev/bus/usb/001/014");
  EXPECT_TRUE(all[0].may_suspend);
  EXPECT_FALSE(all[0].is_hub);
  EXPECT_TRUE(all[2].is_hub);
  EXPECT_EQ(all[0].describe(), "EOS 90D serial 123 (1-1.4)");
}

TEST_F(UsbDevices, AreFoundBySerialWhateverTheirNumber) {
  const auto device = findDevice({0x04a9, 0, "456"}, tree_.root());
  ASSERT_THAT(device, IsOk());
  EXPECT_EQ(device->name, "1-2");
}

TEST_F(UsbDevices, TwoThatFitAreRefused) {
  const auto device = findDevice({0x04a9, 0x32d1, ""}, tree_.root());
  ASSERT_THAT(device, Fails(Errc::kRefused));
  EXPECT_THAT(device.error().what,
              HasSubstr("EOS 90D serial 123 (1-1.4), EOS 90D serial 456 (1-2)"));
}

TEST_F(UsbDevices, AMissingOneIsLostAndTheOthersAreNamed) {
  const auto device = findDevice({0x04a9, 0, "789"}, tree_.root());
  ASSERT_THAT(device, Fails(Errc::kLost));
  EXPECT_THAT(device.error().what,
              HasSubstr("serial 789 is not attached; there are: EOS 90D serial 123"));
  EXPECT_THAT(findDevice({}, tree_.root() / "nowhere"), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::usb
