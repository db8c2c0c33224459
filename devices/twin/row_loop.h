// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of a picture over the threads of oneTBB; small pictures stay on the caller's.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "processing/image/units.h"

// Before a loop whose texels do not touch one another's memory, which a compiler cannot see of many
// pointers: it may vectorise without testing them all.
#ifdef __clang__
#define PATINA_INDEPENDENT_TEXELS
#else
#define PATINA_INDEPENDENT_TEXELS _Pragma("GCC ivdep")
#endif

namespace patina::devices::twin {

// body(y0, y1) for blocks of rows. Every row's result depends on y alone, so the number of threads
// does not matter.
template <class Body>
void forRowBlocks(SizePx size, const Body& body) {
  constexpr long kPixelsWorthAThread = 40'000;
  if (static_cast<long>(size.width) * size.height < kPixelsWorthAThread) {
    body(0, size.height);
    return;
  }
  tbb::parallel_for(tbb::blocked_range<int>(0, size.height, 16),
                    [&](const tbb::blocked_range<int>& r) { body(r.begin(), r.end()); });
}

}  // namespace patina::devices::twin
