// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of an image on the one pool (oneTBB). Small work stays on the calling thread: waking a
// worker costs more than 16,000 cheap texels do. Only .cpp files include this.
#pragma once

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

namespace patina {

// Calls body(y) for 0 <= y < height, in any order and on any thread. `row_cost` counts cheap
// operations a row; bodies must not depend on one another.
template <class Body>
void forEachRow(int height, std::int64_t row_cost, const Body& body) {
  constexpr std::int64_t kGrain = 1 << 14;
  if (height <= 1 || height * row_cost <= 4 * kGrain) {
    for (int y = 0; y < height; ++y) body(y);
    return;
  }
  const auto grain = std::max<std::int64_t>(1, kGrain / std::max<std::int64_t>(1, row_cost));
  tbb::parallel_for(tbb::blocked_range<int>(0, height, static_cast<std::size_t>(grain)),
                    [&](const tbb::blocked_range<int>& rows) {
                      for (int y = rows.begin(); y != rows.end(); ++y) body(y);
                    });
}

}  // namespace patina
