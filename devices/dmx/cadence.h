// SPDX-License-Identifier: GPL-3.0-or-later
// When a universe is sent again. Pure.
#pragma once

#include <chrono>

#include "processing/image/units.h"

namespace patina::devices::dmx {

// E1.31 (6.6) and Art-Net alike: a change at once and, as packets get lost, twice more; then what
// keeps receivers from losing the source (theirs: 2.5 s and more). Never faster than a DMX line.
class Cadence {
 public:
  static constexpr Nanoseconds kShortest = std::chrono::milliseconds(23);  // 44 packets a second
  static constexpr Nanoseconds kRepeat = std::chrono::milliseconds(25);
  static constexpr Nanoseconds kKeepAlive = std::chrono::milliseconds(800);

  void sentChange(MonoTime now) {
    last_ = now;
    repeats_ = 2;
  }
  void sentAgain(MonoTime now) {
    last_ = now;
    if (repeats_ > 0) --repeats_;
  }
  MonoTime due() const { return last_ + (repeats_ > 0 ? kRepeat : kKeepAlive); }
  MonoTime earliest() const { return last_ + kShortest; }

 private:
  MonoTime last_{};
  int repeats_ = 0;
};

}  // namespace patina::devices::dmx
