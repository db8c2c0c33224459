// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/usb/hid_relay.h"

#include <gmock/gmock.h>

#include "tests/devices/usb/fake_board.h"
#include "tests/devices/usb/usb_tree.h"
#include "tests/support/matchers.h"

namespace patina::devices::usb {
namespace {

using patina::testing::Fails;
using patina::testing::FakeBoards;
using patina::testing::IsOk;
using patina::testing::UsbTree;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(RelayReport, HoldsTheSerialAndTheState) {
  const auto state = decodeRelays({'H', 'U', 'R', 'T', 'M', 0, 0, 0x05});
  ASSERT_THAT(state, IsOk());
  EXPECT_EQ(state->serial, "HURTM");
  EXPECT_EQ(state->relays, 5u);
  EXPECT_THAT(decodeRelays({}), Fails(Errc::kCorrupt));
  EXPECT_THAT(relayCommand(3, true), ElementsAre(0xff, 3, 0, 0, 0, 0, 0, 0));
  EXPECT_THAT(relayCommand(8, false), ElementsAre(0xfd, 8, 0, 0, 0, 0, 0, 0));
}

class RelayBoards : public ::testing::Test {
 protected:
  RelayBoards() {
    tree_.addHidraw(0, "0003:0000046D:0000C31C");  // a keyboard
    tree_.addHidraw(1);
    tree_.addHidraw(2);
    boards_.at("hidraw1")->serial = "AAAAA";
    boards_.at("hidraw2")->serial = "BBBBB";
  }
  RelayBoard board(const std::string& serial) {
    return RelayBoard(serial, boards_.opener(), tree_.root());
  }
  UsbTree tree_;
  FakeBoards boards_;
};

TEST_F(RelayBoards, AreFoundByTheirSerialAndNotByTheirNode) {
  RelayBoard b(board("BBBBB"));
  ASSERT_THAT(b.open(), IsOk());
  ASSERT_THAT(b.set(2, true), IsOk());
  EXPECT_EQ(boards_.at("hidraw2")->state, 2u);
  EXPECT_EQ(boards_.at("hidraw1")->state, 0u);
  EXPECT_TRUE(*b.isClosed(2));
  EXPECT_FALSE(*b.isClosed(1));
}

TEST_F(RelayBoards, ComeBackUnderAnotherNode) {
  RelayBoard b(board("BBBBB"));
  ASSERT_THAT(b.open(), IsOk());
  boards_.at("hidraw2")->gone = true;
  EXPECT_THAT(b.set(1, true), Fails(Errc::kLost));
  EXPECT_THAT(b.isClosed(1), Fails(Errc::kLost));
  const auto missing = b.open();
  ASSERT_THAT(missing, Fails(Errc::kLost));
  EXPECT_THAT(missing.error().what, HasSubstr("with serial BBBBB; there are: AAAAA"));
  tree_.removeHidraw(2);
  tree_.addHidraw(7);
  boards_.move("hidraw2", "hidraw7");
  boards_.at("hidraw7")->gone = false;
  ASSERT_THAT(b.open(), IsOk());
  EXPECT_THAT(b.set(1, true), IsOk());
}

TEST_F(RelayBoards, WithoutASerialOnlyASingleOneIsTaken) {
  RelayBoard any(board(""));
  const auto two = any.open();
  ASSERT_THAT(two, Fails(Errc::kRefused));
  EXPECT_THAT(two.error().what, HasSubstr("AAAAA, BBBBB"));
  tree_.removeHidraw(2);
  ASSERT_THAT(any.open(), IsOk());
  EXPECT_THAT(any.set(1, true), IsOk());
  EXPECT_EQ(boards_.at("hidraw1")->state, 1u);
}

TEST_F(RelayBoards, ARelayThatDoesNotFollowIsRefused) {
  RelayBoard b(board("AAAAA"));
  ASSERT_THAT(b.open(), IsOk());
  boards_.at("hidraw1")->relays = 2;
  const auto third = b.set(3, true);
  ASSERT_THAT(third, Fails(Errc::kRefused));
  EXPECT_THAT(third.error().what, HasSubstr("relay 3 of board AAAAA does not follow"));
}

TEST_F(RelayBoards, AnotherBoardUnderTheOldNodeIsNotObeyed) {
  RelayBoard b(board("AAAAA"));
  ASSERT_THAT(b.open(), IsOk());
  boards_.at("hidraw1")->serial = "CCCCC";
  EXPECT_THAT(b.isClosed(1), Fails(Errc::kLost));
}

TEST_F(RelayBoards, AreClosedUntilOpened) {
  RelayBoard b(board("AAAAA"));
  EXPECT_THAT(b.set(1, true), Fails(Errc::kLost));
  EXPECT_THAT(b.isClosed(1), Fails(Errc::kLost));
}

}  // namespace
}  // namespace patina::devices::usb
