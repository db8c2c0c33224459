// SPDX-License-Identifier: GPL-3.0-or-later
// Inside this room.
#pragma once

#include <algorithm>
#include <vector>

namespace patina::calibration {

// The upper one of an even number; of at least one value.
template <class T>
T medianOf(std::vector<T> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace patina::calibration
