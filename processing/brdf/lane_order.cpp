// SPDX-License-Identifier: GPL-3.0-or-later
// Order statistics of sixteen texels side by side.
#include <algorithm>

#include "processing/brdf/fit_lanes.h"

namespace patina::brdf::lanes {
namespace {

void exchange(Lane& low, Lane& high) {
  const Lane a = low, b = high;
  for (int k = 0; k < kLanes; ++k) low.v[k] = std::min(a.v[k], b.v[k]);
  for (int k = 0; k < kLanes; ++k) high.v[k] = std::max(a.v[k], b.v[k]);
}

}  // namespace

// Batcher's odd-even merge sort (1968), which compares the same places whatever the values are.
void sortLanes(std::vector<Lane>& values) {
  const std::size_t n = values.size();
  for (std::size_t run = 1; run < n; run *= 2)
    for (std::size_t apart = run; apart >= 1; apart /= 2)
      for (std::size_t first = apart % run; first + apart < n; first += 2 * apart)
        for (std::size_t i = first; i < first + apart && i + apart < n; ++i)
          if (i / (2 * run) == (i + apart) / (2 * run)) exchange(values[i], values[i + apart]);
}

}  // namespace patina::brdf::lanes
