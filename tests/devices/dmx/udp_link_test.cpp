// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/udp_link.h"

#include <gmock/gmock.h>

#include "tests/devices/dmx/node.h"
#include "tests/support/matchers.h"

namespace patina::devices::dmx {
namespace {

using patina::testing::Fails;
using patina::testing::IsOk;
using patina::testing::Node;
using patina::testing::Packet;

TEST(UdpLink, CarriesThePacketAsItIs) {
  Node node;
  UdpLink link({"127.0.0.1", node.port(), ""});
  ASSERT_THAT(link.open(), IsOk());
  ASSERT_THAT(link.send({1, 2, 3}), IsOk());
  EXPECT_EQ(node.next(), (Packet{1, 2, 3}));
}

TEST(UdpLink, SendsNothingBeforeItIsOpened) {
  UdpLink link({"127.0.0.1", 9, ""});
  EXPECT_THAT(link.send({1}), Fails(Errc::kLost));
}

TEST(UdpLink, SaysThatNobodyListensAndOpeningForgetsIt) {
  int port = 0;
  { port = Node().port(); }
  UdpLink link({"127.0.0.1", port, ""});
  ASSERT_THAT(link.open(), IsOk());
  ASSERT_THAT(link.send({1}), IsOk());  // the refusal comes back after it
  const auto second = link.send({2});
  ASSERT_THAT(second, Fails(Errc::kLost));
  EXPECT_NE(second.error().what.find("nobody listens at 127.0.0.1"), std::string::npos);
  ASSERT_THAT(link.open(), IsOk());
  EXPECT_THAT(link.send({3}), IsOk());
}

TEST(UdpLink, NamesAnInterfaceThatThisMachineHasNot) {
  UdpLink link({"239.255.0.1", 5568, "203.0.113.9"});
  const auto opened = link.open();
  ASSERT_THAT(opened, Fails(Errc::kLost));
  EXPECT_NE(opened.error().what.find("203.0.113.9"), std::string::npos);
}

TEST(IsIpv4, TakesAddressesAndNoNames) {
  EXPECT_TRUE(isIpv4("10.0.0.7"));
  for (const char* text : {"", "lamp.local", "10.0.0", "10.0.0.256", "::1"})
    EXPECT_FALSE(isIpv4(text)) << text;
}

}  // namespace
}  // namespace patina::devices::dmx
