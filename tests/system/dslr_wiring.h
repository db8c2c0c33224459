// SPDX-License-Identifier: GPL-3.0-or-later
// How a virtual DSLR is wired and set.
#pragma once

#include <cstdint>
#include <string>

#include "processing/image/random.h"

namespace patina::testing {

struct DslrWiring {
  bool usb = false;     // else PTP/IP
  bool memory = false;  // pictures go to the camera's memory instead of its card
  bool line = false;    // the shutter is fired by a line
  std::string format = "jpeg";

  std::string text() const {
    return std::string(usb ? "USB" : "PTP/IP") + ", " + format + (memory ? " in memory" : "") +
           (line ? ", shutter line" : "");
  }
  std::size_t files() const { return format == "raw+jpeg" ? 2 : 1; }
};

// At random, but for the first part of the first seeds: they have everything once.
inline DslrWiring wiringOf(bool usb, std::uint64_t seed, std::uint64_t part) {
  if (part == 0 && seed == 1) return {usb, false, false, usb ? "raw+jpeg" : "jpeg"};
  if (part == 0 && seed == 2) return {usb, false, true, "raw"};
  if (part == 0 && seed == 3) return {usb, false, false, "raw+jpeg"};
  if (part == 0 && seed == 4) return {usb, true, false, "jpeg"};
  const auto draw = [&](std::uint64_t what, std::uint64_t n) {
    return uniformBelow(hashSeed(seed, part, what), n);
  };
  const char* const formats[] = {"jpeg", "raw", "raw+jpeg"};
  return {usb, draw(0, 4) == 0, draw(1, 4) == 0, formats[draw(2, 3)]};
}

}  // namespace patina::testing
