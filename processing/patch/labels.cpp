// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/labels.h"

#include <algorithm>
#include <cstdlib>

namespace patina::patch {

bool Labels::hasCopy(std::int32_t centre, std::size_t at) const {
  const Copy& copy = of_target[at];
  const auto near = [&](int begin, int place, int length) {
    const int off = std::abs(begin - place);
    return (wraps ? std::min(off % length, length - off % length) : off) <= slack;
  };
  const int x = static_cast<int>(at) % target.width, y = static_cast<int>(at) / target.width;
  return copy.label == of_source[static_cast<std::size_t>(centre)] &&
         near(x - centre % source.width, copy.x, target.width) &&
         near(y - centre / source.width, copy.y, target.height);
}

}  // namespace patina::patch
