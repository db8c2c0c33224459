// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/decomposition/sample_block.h"

namespace patina::decomposition {

FloatRows floatRows(const SampleBlock& block, Index row, Index rows, Index first, Index count,
                    std::vector<float>& room) {
  const Index at = row * block.stride + first;
  if (!block.codes) return {block.data + at, block.stride};
  room.resize(static_cast<std::size_t>(rows * count));
  for (Index j = 0; j < rows; ++j) {
    const std::uint8_t* codes = block.codes + at + j * block.stride;
    float* out = room.data() + j * count;
    for (Index i = 0; i < count; ++i) out[i] = static_cast<float>(codes[i]) * block.step;
  }
  return {room.data(), count};
}

}  // namespace patina::decomposition
