// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/occupancy.h"

#include <cstdlib>

namespace patina::patch {

Occupancy::Occupancy(SizePx source, int patch)
    : patch_(patch),
      reach_(patch - 1),
      stride_(static_cast<std::size_t>(source.width + 2 * reach_)),
      sums_(stride_ * static_cast<std::size_t>(source.height + 2 * reach_), 0) {
  for (int y = -reach_; y <= reach_; ++y)
    for (int x = -reach_; x <= reach_; ++x)
      tent_.push_back((patch - std::abs(y)) * (patch - std::abs(x)));
}

void Occupancy::change(int x, int y, int sign) {
  const int side = 2 * patch_ - 1;
  const std::int32_t* tent = tent_.data();
  std::int32_t* row = &sums_[static_cast<std::size_t>(y) * stride_ + static_cast<std::size_t>(x)];
  for (int i = 0; i < side; ++i, row += stride_, tent += side)
    for (int j = 0; j < side; ++j) row[j] += sign * tent[j];
}

}  // namespace patina::patch
