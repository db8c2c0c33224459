// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/dmx/packets.h"

#include <algorithm>
#include <string_view>

namespace patina::devices::dmx {
namespace {

using Packet = std::vector<std::uint8_t>;
using namespace std::string_view_literals;

constexpr std::uint8_t kStreamTerminated = 0x40;
constexpr std::size_t kSourceNameBytes = 64;  // the last one is 0

void put(Packet& packet, std::string_view bytes) {
  packet.insert(packet.end(), bytes.begin(), bytes.end());
}
void put8(Packet& packet, int v) { packet.push_back(static_cast<std::uint8_t>(v)); }
void put16(Packet& packet, int v) {
  put8(packet, v >> 8);
  put8(packet, v & 0xff);
}
void put32(Packet& packet, int v) {
  put16(packet, v >> 16);
  put16(packet, v & 0xffff);
}
// Flags 0x7 and the number of bytes from here to the end of the packet.
void putLength(Packet& packet) {
  constexpr int kTotal = 638;
  put16(packet, 0x7000 | (kTotal - static_cast<int>(packet.size())));
}

Packet sacn(const SacnSource& source, int universe, std::uint8_t sequence, std::uint8_t options,
            const Slots& slots) {
  Packet packet;
  packet.reserve(638);
  put16(packet, 0x0010);  // root layer: preamble, postamble
  put16(packet, 0);
  put(packet, "ASC-E1.17\0\0\0"sv);
  putLength(packet);
  put32(packet, 4);  // VECTOR_ROOT_E131_DATA
  packet.insert(packet.end(), source.cid.begin(), source.cid.end());

  putLength(packet);  // framing layer
  put32(packet, 2);   // VECTOR_E131_DATA_PACKET
  const std::string name = source.name.substr(0, kSourceNameBytes - 1);
  put(packet, name);
  packet.resize(packet.size() + kSourceNameBytes - name.size());
  put8(packet, source.priority);
  put16(packet, 0);  // no synchronization
  put8(packet, sequence);
  put8(packet, options);
  put16(packet, universe);

  putLength(packet);   // device management layer
  put8(packet, 2);     // VECTOR_DMP_SET_PROPERTY
  put8(packet, 0xa1);  // addresses and data as DMX has them
  put16(packet, 0);    // first address
  put16(packet, 1);    // increment
  put16(packet, 513);  // start code and slots
  put8(packet, 0);     // start code: levels
  packet.insert(packet.end(), slots.begin(), slots.end());
  return packet;
}

}  // namespace

std::vector<std::uint8_t> artDmx(int universe, std::uint8_t sequence, const Slots& slots) {
  Packet packet;
  packet.reserve(18 + slots.size());
  put(packet, "Art-Net\0"sv);
  put16(packet, 0x0050);  // OpDmx 0x5000, low byte first
  put16(packet, 14);      // protocol version
  put8(packet, sequence);
  put8(packet, 0);  // physical input: none
  put8(packet, universe & 0xff);
  put8(packet, universe >> 8);
  put16(packet, static_cast<int>(slots.size()));
  packet.insert(packet.end(), slots.begin(), slots.end());
  return packet;
}

std::vector<std::uint8_t> sacnData(const SacnSource& source, int universe, std::uint8_t sequence,
                                   const Slots& slots) {
  return sacn(source, universe, sequence, 0, slots);
}

std::vector<std::uint8_t> sacnTerminated(const SacnSource& source, int universe,
                                         std::uint8_t sequence, const Slots& slots) {
  return sacn(source, universe, sequence, kStreamTerminated, slots);
}

std::string sacnMulticastGroup(int universe) {
  return "239.255." + std::to_string(universe >> 8) + "." + std::to_string(universe & 0xff);
}

}  // namespace patina::devices::dmx
