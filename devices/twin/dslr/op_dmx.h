// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace patina::devices::twin::dslr {

struct DmxFrame {
  int universe = 0;  // the 15-bit port address
  std::vector<std::uint8_t> slots;
};
// An OpDmx packet (Art-Net 4); nothing for any other bytes.
std::optional<DmxFrame> parseOpDmx(std::span<const std::byte> packet);

}  // namespace patina::devices::twin::dslr
