// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "devices/usb/usb.h"
#include "tests/devices/usb/fake_board.h"
#include "tests/devices/usb/usb_tree.h"

namespace patina::devices::usb {
namespace {

TEST(FindUsb, ListsRelayBoardsAndHubsAndWhatIsWrongWithThem) {
  patina::testing::UsbTree tree;
  tree.addHidraw(0);
  tree.addHidraw(1);
  tree.add({.name = "1-1", .model = "Hub", .hub = true});
  tree.add({.name = "1-1.1", .model = "Camera"});
  patina::testing::FakeBoards boards;
  boards.at("hidraw0")->state = 5;
  boards.at("hidraw1")->gone = true;
  const auto found = find({tree.root(), boards.opener()});
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].serial, "HURTM");
  EXPECT_EQ(found[0].address, "/dev/hidraw0");
  EXPECT_EQ(found[0].facts.at(0).second, "1 3");
  EXPECT_EQ(found[1].state, "does not answer");
  ASSERT_EQ(found[1].troubles.size(), 1u);
  EXPECT_EQ(found[2].kind, "hub");
  EXPECT_EQ(found[2].address, "1-1");
  EXPECT_EQ(found[2].state, "does not answer");  // no node in this tree
}

}  // namespace
}  // namespace patina::devices::usb
