// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/artnet_poll.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <string>
#include <thread>

#include "tests/devices/dmx/node.h"

namespace patina::devices::dmx {
namespace {

using namespace std::chrono_literals;
using patina::testing::Node;
using patina::testing::Packet;
using ::testing::ElementsAre;

void put(Packet& packet, std::size_t at, const std::string& bytes) {
  std::ranges::copy(bytes, packet.begin() + static_cast<std::ptrdiff_t>(at));
}

Packet reply() {
  Packet packet(239);
  put(packet, 0, std::string("Art-Net\0\x00\x21", 10));
  put(packet, 10, "\x0a\x01\x02\x03");
  packet[18] = 1;  // net
  packet[19] = 2;  // sub-net
  put(packet, 26, "node");
  put(packet, 44, "A node with two outputs");
  packet[174] = 0x80;
  packet[175] = 0xc5;
  packet[190] = 3;
  packet[191] = 4;
  put(packet, 201, "\x02\xaa\xbb\xcc\xdd\xee");
  return packet;
}

TEST(ArtPoll, AsksAsTheStandardSays) {
  EXPECT_THAT(artPoll(), ElementsAre('A', 'r', 't', '-', 'N', 'e', 't', 0, 0, 0x20, 0, 14, 0, 0));
}

TEST(ArtPollReply, TellsNameAddressAndTheUniversesOfItsOutputs) {
  const auto node = decodeArtPollReply(reply());
  ASSERT_TRUE(node);
  EXPECT_EQ(node->ip, "10.1.2.3");
  EXPECT_EQ(node->mac, "02:aa:bb:cc:dd:ee");
  EXPECT_EQ(node->short_name, "node");
  EXPECT_EQ(node->long_name, "A node with two outputs");
  EXPECT_THAT(node->universes, ElementsAre(0x123, 0x124));
}

TEST(ArtPollReply, IsNotReadOutOfAnythingElse) {
  Packet cut = reply();
  cut.resize(206);
  EXPECT_FALSE(decodeArtPollReply(cut));
  Packet dmx = reply();
  dmx[9] = 0x50;
  EXPECT_FALSE(decodeArtPollReply(dmx));
  EXPECT_FALSE(decodeArtPollReply({}));
}

TEST(ArtPoll, FindsTheNodesThatAnswerEachOnce) {
  Node node;
  std::thread answering([&node] {
    if (!node.next()) return;
    node.answer({1, 2, 3});
    node.answer(reply());
    node.answer(reply());
  });
  const auto found = find({"127.0.0.1", node.port(), 0, 300ms});
  answering.join();
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].serial, "02:aa:bb:cc:dd:ee");
  EXPECT_EQ(found[0].address, "10.1.2.3");
  EXPECT_THAT(found[0].choices.at(0).second, ElementsAre("291", "292"));
}

TEST(ArtPoll, FindsNothingWhereNobodyAnswers) {
  Node silent;
  EXPECT_TRUE(find({"127.0.0.1", silent.port(), 0, 1ms}).empty());
  EXPECT_TRUE(find({"no address", silent.port(), 0, 1ms}).empty());
}

}  // namespace
}  // namespace patina::devices::dmx
