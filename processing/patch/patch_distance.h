// SPDX-License-Identifier: GPL-3.0-or-later
// Squared difference of two square patches of int16 features. Integers: every SIMD path gives the
// same number.
#pragma once

#include <cstddef>
#include <cstdint>

#include "processing/image/simd_path.h"

namespace patina::patch {

// a, b: upper left texels; rows `a_stride`, `b_stride` numbers apart. A sum that has reached
// `bound` after any two rows comes back as it is then.
using PatchDistance = std::int32_t (*)(const std::int16_t* a, const std::int16_t* b,
                                       std::ptrdiff_t a_stride, std::ptrdiff_t b_stride,
                                       std::int32_t bound);

// For patches of `patch` x `patch` texels (3, 5 or 7) of `components` numbers (4, 8 or 16).
PatchDistance patchDistance(int patch, int components, SimdPath path);

}  // namespace patina::patch
