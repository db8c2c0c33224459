// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/ptpip_packets.h"

#include <gtest/gtest.h>

#include "devices/twin/dslr/ptp_data.h"

namespace patina::devices::twin::dslr {
namespace {

Bytes bytes(std::initializer_list<int> values) {
  Bytes out;
  for (const int v : values) out.push_back(static_cast<std::byte>(v));
  return out;
}

std::vector<Packet> packetsIn(const Bytes& stream) {
  PacketReader reader;
  reader.feed(stream);
  std::vector<Packet> packets;
  while (auto packet = reader.next()) packets.push_back(std::move(*packet));
  EXPECT_FALSE(reader.bad());
  return packets;
}

Packet packet(PacketType type, const Bytes& payload) { return {type, payload}; }

// OpenSession(1) as libgphoto2 sends it.
const Bytes kOpenSession =
    bytes({22, 0, 0, 0, 6, 0, 0, 0, 1, 0, 0, 0, 0x02, 0x10, 0, 0, 0, 0, 1, 0, 0, 0});

TEST(PacketReader, PutsPacketsTogetherFromAnyPieces) {
  Bytes stream = kOpenSession;
  stream.insert(stream.end(), kOpenSession.begin(), kOpenSession.end());
  for (std::size_t piece = 1; piece < 9; ++piece) {
    PacketReader reader;
    int packets = 0;
    for (std::size_t at = 0; at < stream.size(); at += piece) {
      reader.feed(std::span(stream).subspan(at, std::min(piece, stream.size() - at)));
      while (const auto one = reader.next()) {
        ++packets;
        EXPECT_EQ(one->type, PacketType::kCommandRequest);
        EXPECT_EQ(one->payload.size(), kOpenSession.size() - 8);
      }
    }
    EXPECT_EQ(packets, 2) << piece;
  }
}

TEST(PacketReader, RefusesLengthsThatNoPacketHasAndAllThatFollows) {
  for (const Bytes& length : {bytes({7, 0, 0, 0}), bytes({0, 0, 0, 0}), bytes({1, 0, 16, 0}),
                              bytes({255, 255, 255, 255})}) {
    PacketReader reader;
    Bytes stream = length;
    const Bytes type = bytes({6, 0, 0, 0});
    stream.insert(stream.end(), type.begin(), type.end());
    reader.feed(stream);
    EXPECT_FALSE(reader.next());
    EXPECT_TRUE(reader.bad());
    reader.feed(kOpenSession);
    EXPECT_FALSE(reader.next());
  }
}

TEST(CommandReader, ReadsARequestWithItsParameters) {
  CommandReader reader;
  const auto command = reader.take(packetsIn(kOpenSession).at(0));
  ASSERT_TRUE(command);
  EXPECT_EQ(command->operation, Operation::kOpenSession);
  EXPECT_EQ(command->parameters, std::vector<std::uint32_t>{1});
}

class CommandWithData : public ::testing::Test {
 protected:
  void SetUp() override {
    EXPECT_FALSE(
        reader_.take(packet(PacketType::kCommandRequest,
                            bytes({2, 0, 0, 0, 0x16, 0x10, 9, 0, 0, 0, 0x0D, 0x50, 0, 0}))));
  }
  std::optional<PtpCommand> start(int announced) {
    return reader_.take(
        packet(PacketType::kStartData, bytes({9, 0, 0, 0, announced, 0, 0, 0, 0, 0, 0, 0})));
  }
  CommandReader reader_;
};

TEST_F(CommandWithData, WaitsForAllOfIt) {
  EXPECT_FALSE(start(4));
  EXPECT_FALSE(reader_.take(packet(PacketType::kData, bytes({9, 0, 0, 0, 100, 0}))));
  const auto command = reader_.take(packet(PacketType::kEndData, bytes({9, 0, 0, 0, 0, 0})));
  ASSERT_TRUE(command);
  EXPECT_EQ(command->operation, Operation::kSetDevicePropValue);
  EXPECT_EQ(command->data, bytes({100, 0, 0, 0}));
  EXPECT_FALSE(reader_.bad());
}

TEST_F(CommandWithData, RefusesMoreThanWasAnnounced) {
  EXPECT_FALSE(start(1));
  EXPECT_FALSE(reader_.take(packet(PacketType::kEndData, bytes({9, 0, 0, 0, 100, 0}))));
  EXPECT_TRUE(reader_.bad());
}

TEST_F(CommandWithData, RefusesLessAnnouncedThanHasCome) {
  EXPECT_FALSE(start(4));
  EXPECT_FALSE(reader_.take(packet(PacketType::kData, bytes({9, 0, 0, 0, 1, 2, 3, 4}))));
  EXPECT_FALSE(start(1));
  EXPECT_FALSE(reader_.take(packet(PacketType::kEndData, bytes({9, 0, 0, 0, 100, 0}))));
  EXPECT_TRUE(reader_.bad());
}

TEST_F(CommandWithData, RefusesDataOfAnotherTransaction) {
  EXPECT_FALSE(start(4));
  EXPECT_FALSE(reader_.take(packet(PacketType::kEndData, bytes({8, 0, 0, 0, 1, 2}))));
  EXPECT_TRUE(reader_.bad());
}

TEST_F(CommandWithData, ForgetsItWhenItIsCancelled) {
  EXPECT_FALSE(reader_.take(packet(PacketType::kCancel, bytes({9, 0, 0, 0}))));
  EXPECT_FALSE(reader_.bad());
  EXPECT_FALSE(start(4));
  EXPECT_TRUE(reader_.bad());
}

TEST(ReplyPackets, SplitDataAndEndWithTheResponse) {
  PtpReply reply;
  reply.data = std::make_shared<const Bytes>(100'000, std::byte{7});
  reply.first = 10;
  reply.bytes = 99'000;
  reply.parameters = {99'000};
  const auto packets = packetsIn(replyPackets(reply, 5));
  ASSERT_EQ(packets.size(), 4u);
  EXPECT_EQ(packets[0].type, PacketType::kStartData);
  EXPECT_EQ(packets[1].type, PacketType::kData);
  EXPECT_EQ(packets[2].type, PacketType::kEndData);
  EXPECT_EQ(packets[1].payload.size() + packets[2].payload.size(), 99'000u + 8);
  EXPECT_EQ(packets[3].type, PacketType::kCommandResponse);
  EXPECT_EQ(packets[3].payload, bytes({0x01, 0x20, 5, 0, 0, 0, 0xB8, 0x82, 1, 0}));
}

TEST(EventPacket, IsAsTheStandardHasIt) {
  EXPECT_EQ(eventPacket({EventCode::kObjectAdded, 3, {0x11}}),
            bytes({18, 0, 0, 0, 8, 0, 0, 0, 0x02, 0x40, 3, 0, 0, 0, 0x11, 0, 0, 0}));
}

TEST(InitCommandAck, NamesTheCameraByAnIdentityOfItsOwn) {
  const auto one = packetsIn(initCommandAck(1, "Patina DSLR", "1001")).at(0).payload;
  const auto same = packetsIn(initCommandAck(2, "Patina DSLR", "1001")).at(0).payload;
  const auto other = packetsIn(initCommandAck(1, "Patina DSLR", "2002")).at(0).payload;
  EXPECT_EQ(Bytes(one.begin() + 4, one.end()), Bytes(same.begin() + 4, same.end()));
  EXPECT_NE(one, other);
}

}  // namespace
}  // namespace patina::devices::twin::dslr
