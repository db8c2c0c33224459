// SPDX-License-Identifier: GPL-3.0-or-later
// Some texels of T, as a pass over the data sees them. Inside this room only.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace patina::decomposition {

using Index = std::int64_t;

// Row j holds sample j of `count` texels, as floats or as codes of 8 bits, `step` each; borrowed.
struct SampleBlock {
  const float* data = nullptr;
  const std::uint8_t* codes = nullptr;
  float step = 1;
  Index count = 0, stride = 0;

  // Rows to take at once where floats are wanted: of codes few enough for a cache.
  Index rowsAtOnce(Index n) const { return codes ? std::min(n, kCodedRows) : n; }

 private:
  static constexpr Index kCodedRows = 128;
};

struct FloatRows {
  const float* data;
  Index stride;
};
// Rows [row, row + rows) of texels [first, first + count); in `room` where they are codes.
FloatRows floatRows(const SampleBlock& block, Index row, Index rows, Index first, Index count,
                    std::vector<float>& room);

// What a pass hands to one task at a time: wide enough for BLAS, small enough for a cache.
inline constexpr Index kPanelTexels = 512;

}  // namespace patina::decomposition
