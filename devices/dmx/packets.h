// SPDX-License-Identifier: GPL-3.0-or-later
// The two packets that carry a DMX universe over UDP, byte by byte.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace patina::devices::dmx {

using Slots = std::array<std::uint8_t, 512>;  // slot 0 is channel 1

constexpr int kArtNetPort = 6454, kSacnPort = 5568;
constexpr int kArtNetUniverseMax = 32767,
              kSacnUniverseMax = 63999;  // Art-Net's from 0, sACN's from 1

// Art-Net 4, OpDmx: 18 bytes and the slots. `universe`: the 15-bit port address. `sequence`: 1 to
// 255; 0 would tell the receiver not to look at it.
std::vector<std::uint8_t> artDmx(int universe, std::uint8_t sequence, const Slots& slots);

struct SacnSource {
  std::array<std::uint8_t, 16> cid{};  // of this sender, the same for ever
  std::string name;                    // UTF-8, cut at 63 bytes
  int priority = 100;                  // 0 to 200: receivers follow the highest
};
// ANSI E1.31-2018, data packet: 126 bytes and the slots.
std::vector<std::uint8_t> sacnData(const SacnSource& source, int universe, std::uint8_t sequence,
                                   const Slots& slots);
// The same with Stream_Terminated: receivers forget this source at once.
std::vector<std::uint8_t> sacnTerminated(const SacnSource& source, int universe,
                                         std::uint8_t sequence, const Slots& slots);
// "239.255.x.y"
std::string sacnMulticastGroup(int universe);

}  // namespace patina::devices::dmx
