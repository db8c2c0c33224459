// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string_view>

namespace patina::http {

struct ByteRange {
  enum Kind { kWhole, kPart, kRefused } kind = kWhole;
  std::uint64_t first = 0, bytes = 0;  // of what is to be sent
};

// What a Range field asks of a file of `size` bytes. One range only: a client that names several
// costs more than it says, so it is refused (416), as is one that lies outside or makes no sense.
// An empty field asks for the whole.
ByteRange chooseRange(std::string_view field, std::uint64_t size);

}  // namespace patina::http
