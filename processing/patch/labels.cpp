// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/labels.h"

#include <algorithm>
#include <cstdlib>

namespace patina::patch {

bool Labels::refuse(std::int32_t centre, std::size_t at) const {
  if (of_source.empty()) return false;
  const std::int32_t label = of_source[static_cast<std::size_t>(centre)];
  if (label < 0) return false;
  const Copy& copy = of_target[at];
  if (label != copy.label) return true;
  const auto beside = [&](int begin, int place, int length) {
    const int off = std::abs(begin - place);
    return (wraps ? std::min(off % length, length - off % length) : off) > slack;
  };
  const int x = static_cast<int>(at) % target.width, y = static_cast<int>(at) / target.width;
  return beside(x - centre % source.width, copy.x, target.width) ||
         beside(y - centre / source.width, copy.y, target.height);
}

}  // namespace patina::patch
