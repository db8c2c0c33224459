// SPDX-License-Identifier: GPL-3.0-or-later
// Some texels of T, as a pass over the data sees them. Inside this room only.
#pragma once

#include <cstdint>

namespace patina::decomposition {

using Index = std::int64_t;

// Row j holds sample j of `count` texels; borrowed.
struct SampleBlock {
  const float* data = nullptr;
  Index count = 0, stride = 0;
};

// What a pass hands to one task at a time: wide enough for BLAS, small enough for a cache.
inline constexpr Index kPanelTexels = 512;

}  // namespace patina::decomposition
