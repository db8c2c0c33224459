// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "processing/image/picture_file.h"

namespace patina::devices::twin::dslr {

// As Art-Net 4 lays it out.
inline Bytes opDmx(int universe, std::vector<int> slots) {
  Bytes packet;
  for (const int v : {int('A'), int('r'), int('t'), int('-'), int('N'), int('e'), int('t'), 0, 0,
                      0x50, 0, 14, 0, 0, universe & 255, universe >> 8,
                      static_cast<int>(slots.size()) >> 8, static_cast<int>(slots.size()) & 255})
    packet.push_back(static_cast<std::byte>(v));
  for (const int v : slots) packet.push_back(static_cast<std::byte>(v));
  return packet;
}

}  // namespace patina::devices::twin::dslr
