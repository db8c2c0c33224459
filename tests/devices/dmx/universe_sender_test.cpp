// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/universe_sender.h"

#include <gmock/gmock.h>

#include "tests/devices/dmx/node.h"
#include "tests/support/matchers.h"

namespace patina::devices::dmx {
namespace {

using patina::testing::IsOk;
using patina::testing::Node;
using patina::testing::Packet;
using namespace std::chrono_literals;

constexpr UtcTime kStart = utcFromNs(1'714'564'800'000'000'000);

Universe artnetTo(const Node& node) {
  return {Universe::kArtNet, {"127.0.0.1", node.port(), ""}, 0, {}};
}
Universe sacnTo(const Node& node) {
  return {Universe::kSacn, {"127.0.0.1", node.port(), ""}, 1, {}};
}
int artSlot(const Packet& packet, std::size_t slot) { return packet.at(18 + slot); }

TEST(Cadence, RepeatsAChangeTwiceAndThenKeepsItAlive) {
  Cadence cadence;
  const MonoTime t = monoFromNs(1'000'000'000);
  cadence.sentChange(t);
  EXPECT_EQ(cadence.due(), t + 25ms);
  cadence.sentAgain(t + 25ms);
  EXPECT_EQ(cadence.due(), t + 50ms);
  cadence.sentAgain(t + 50ms);
  EXPECT_EQ(cadence.due(), t + 850ms);
  cadence.sentChange(t + 60ms);
  EXPECT_EQ(cadence.due(), t + 85ms);
}

TEST(UniverseSender, SendsDarkWhenOpenedAndAChangeAtOnce) {
  Node node;
  VirtualClock clock(kStart);
  UniverseSender sender(artnetTo(node), clock);
  ASSERT_THAT(sender.open(), IsOk());
  ASSERT_THAT(sender.put({{4, 200}}), IsOk());
  const auto packets = node.waiting();
  ASSERT_EQ(packets.size(), 2u);
  EXPECT_EQ(artSlot(packets[0], 4), 0);
  EXPECT_EQ(artSlot(packets[1], 4), 200);
  EXPECT_EQ(packets[1][12], packets[0][12] + 1);  // the sequence
}

TEST(UniverseSender, CountsArtNetSequencesFrom1To255) {
  Node node;
  VirtualClock clock(kStart);
  UniverseSender sender(artnetTo(node), clock);
  ASSERT_THAT(sender.open(), IsOk());
  for (int i = 0; i < 260; ++i) {
    ASSERT_THAT(sender.put({{0, static_cast<std::uint8_t>(i)}}), IsOk());
    EXPECT_EQ(node.next()->at(12), i % 255 + 1);
  }
}

TEST(UniverseSender, GoesDarkThreeTimesWhenItIsDestroyed) {
  Node node;
  VirtualClock clock(kStart);
  {
    UniverseSender sender(artnetTo(node), clock);
    ASSERT_THAT(sender.open(), IsOk());
    ASSERT_THAT(sender.put({{0, 255}, {1, 255}}), IsOk());
  }
  const auto packets = node.waiting();
  ASSERT_EQ(packets.size(), 5u);
  EXPECT_EQ(artSlot(packets[1], 0), 255);
  for (std::size_t i = 2; i < 5; ++i) EXPECT_EQ(artSlot(packets[i], 0), 0);
}

TEST(UniverseSender, EndsAnSacnStreamThreeTimes) {
  Node node;
  VirtualClock clock(kStart);
  {
    UniverseSender sender(sacnTo(node), clock);
    ASSERT_THAT(sender.open(), IsOk());
  }
  const auto packets = node.waiting();
  ASSERT_EQ(packets.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) {
    EXPECT_EQ(packets[i].at(112), i < 4 ? 0 : 0x40) << i;
    EXPECT_EQ(packets[i].at(111), i + 1);
  }
}

TEST(UniverseSender, RepeatsAChangeByItself) {
  Node node;
  RealClock clock;
  UniverseSender sender(artnetTo(node), clock);
  ASSERT_THAT(sender.open(), IsOk());
  ASSERT_THAT(sender.put({{0, 99}}), IsOk());
  for (int lit = 0; lit < 4;) {  // the change, twice more, and once to keep it alive
    const auto packet = node.next();
    ASSERT_TRUE(packet);
    if (artSlot(*packet, 0) == 99) ++lit;
  }
}

TEST(UniverseSender, FallsBackToDarkWhenLightCannotBeSent) {
  Node node;
  RealClock clock;
  UniverseSender sender(artnetTo(node), clock);
  EXPECT_FALSE(sender.put({{0, 255}}));  // not open
  ASSERT_THAT(sender.open(), IsOk());
  EXPECT_EQ(artSlot(*node.next(), 0), 0);
}

TEST(UniverseSender, KeepsTheSlotsOfEachLampApart) {
  Node node;
  VirtualClock clock(kStart);
  UniverseSender sender(artnetTo(node), clock);
  EXPECT_EQ(sender.claim("key", {0, 1}), std::nullopt);
  EXPECT_EQ(sender.claim("fill", {1, 2}), "key");
  sender.giveUp("key");
  EXPECT_EQ(sender.claim("fill", {1, 2}), std::nullopt);
}

}  // namespace
}  // namespace patina::devices::dmx
