// SPDX-License-Identifier: GPL-3.0-or-later
// How often each source patch is shown: the sum over its texels of how many target patches cover
// them. Kept current by one small update a change, so that a judge of candidates looks up one
// number.
#pragma once

#include <cstdint>
#include <vector>

#include "processing/image/image.h"

namespace patina::patch {

class Occupancy {
 public:
  Occupancy(SizePx source, int patch);

  // One target patch more (or less) shows the source patch around (x,y).
  void add(int x, int y) { change(x, y, 1); }
  void remove(int x, int y) { change(x, y, -1); }
  // Of the source patch around (x,y): covered texels, counted as often as they are covered.
  std::int32_t at(int x, int y) const {
    return sums_[static_cast<std::size_t>(y + reach_) * stride_ +
                 static_cast<std::size_t>(x + reach_)];
  }

 private:
  void change(int x, int y, int sign);

  int patch_, reach_;
  std::size_t stride_;
  std::vector<std::int32_t> tent_;  // [2 patch - 1][2 patch - 1]: texels that two patches share
  std::vector<std::int32_t> sums_;  // with a margin, so that no update needs a test
};

}  // namespace patina::patch
