// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/packets.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <iterator>

namespace patina::devices::dmx {
namespace {

using ::testing::ElementsAre;

using Packet = std::vector<std::uint8_t>;

Slots levels(std::initializer_list<int> first) {
  Slots slots{};
  std::ranges::copy(first, slots.begin());
  return slots;
}
Packet part(const Packet& packet, std::size_t from, std::size_t bytes) {
  return {packet.begin() + static_cast<std::ptrdiff_t>(from),
          packet.begin() + static_cast<std::ptrdiff_t>(from + bytes)};
}
Packet hex(const std::string& text) {
  Packet bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    while (text[i] == ' ') ++i;
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  }
  return bytes;
}
SacnSource source() {
  SacnSource s;
  for (std::size_t i = 0; i < s.cid.size(); ++i) s.cid[i] = static_cast<std::uint8_t>(0xc0 + i);
  s.name = "Patina";
  s.priority = 100;
  return s;
}

TEST(ArtDmx, HasTheHeaderOfTheStandardAndTheSlots) {
  const Packet packet = artDmx(0x1234, 7, levels({10, 20, 30}));
  ASSERT_EQ(packet.size(), 530u);
  //               A r t - N e t \0     OpDmx  version seq phys uni net length
  EXPECT_EQ(part(packet, 0, 18), hex("4172742d4e657400 0050 000e 07 00 34 12 0200"));
  EXPECT_THAT(part(packet, 18, 4), ElementsAre(10, 20, 30, 0));
}

TEST(SacnData, HasTheThreeLayersOfTheStandard) {
  const Packet packet = sacnData(source(), 7962, 9, levels({255, 1}));
  ASSERT_EQ(packet.size(), 638u);
  EXPECT_EQ(part(packet, 0, 22), hex("0010 0000 4153432d45312e3137000000 726e 00000004"));
  EXPECT_EQ(part(packet, 22, 16), hex("c0c1c2c3c4c5c6c7c8c9cacbcccdcecf"));
  EXPECT_EQ(part(packet, 38, 6), hex("7258 00000002"));
  EXPECT_EQ(part(packet, 44, 8), hex("506174696e61 0000"));
  EXPECT_TRUE(std::ranges::all_of(part(packet, 50, 58), [](int b) { return b == 0; }));
  //        priority, synchronization, sequence, options, universe
  EXPECT_EQ(part(packet, 108, 7), hex("64 0000 09 00 1f1a"));
  EXPECT_EQ(part(packet, 115, 11), hex("720b 02 a1 0000 0001 0201 00"));
  EXPECT_THAT(part(packet, 126, 3), ElementsAre(255, 1, 0));
}

TEST(SacnTerminated, DiffersByTheOptionAlone) {
  Packet data = sacnData(source(), 1, 3, Slots{});
  data[112] = 0x40;
  EXPECT_EQ(sacnTerminated(source(), 1, 3, Slots{}), data);
}

TEST(SacnData, KeepsALongNameInItsFieldWithAZeroAtTheEnd) {
  SacnSource loud = source();
  loud.name = std::string(200, 'x');
  const Packet packet = sacnData(loud, 1, 0, Slots{});
  ASSERT_EQ(packet.size(), 638u);
  EXPECT_EQ(packet[106], 'x');
  EXPECT_EQ(packet[107], 0);
  EXPECT_EQ(packet[108], 100);
}

TEST(SacnMulticastGroup, HasTheUniverseInItsLastTwoBytes) {
  EXPECT_EQ(sacnMulticastGroup(1), "239.255.0.1");
  EXPECT_EQ(sacnMulticastGroup(63999), "239.255.249.255");
}

}  // namespace
}  // namespace patina::devices::dmx
