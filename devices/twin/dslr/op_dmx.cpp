// SPDX-License-Identifier: GPL-3.0-or-later
#include "devices/twin/dslr/op_dmx.h"

#include <array>
#include <cstring>

#include "devices/twin/dslr/ptp_data.h"

namespace patina::devices::twin::dslr {
namespace {

constexpr std::array<char, 8> kMark = {'A', 'r', 't', '-', 'N', 'e', 't', '\0'};
constexpr std::uint16_t kOpDmx = 0x5000, kUniverseMask = 0x7FFF;
constexpr std::size_t kSlotsMax = 512;

}  // namespace

std::optional<DmxFrame> parseOpDmx(std::span<const std::byte> packet) {
  PtpReader from(packet);
  const auto mark = from.raw(kMark.size());
  if (from.bad() || std::memcmp(mark.data(), kMark.data(), kMark.size()) != 0) return std::nullopt;
  const std::uint16_t operation = from.u16();
  from.u16();  // the protocol's version, high byte first
  from.u16();  // sequence and physical port
  DmxFrame frame;
  frame.universe = from.u16() & kUniverseMask;
  const unsigned high = from.u8(), low = from.u8();
  const std::size_t count = high << 8 | low;
  const auto slots = from.raw(count);
  if (from.bad() || operation != kOpDmx || count > kSlotsMax) return std::nullopt;
  for (const std::byte slot : slots) frame.slots.push_back(std::to_integer<std::uint8_t>(slot));
  return frame;
}

}  // namespace patina::devices::twin::dslr
