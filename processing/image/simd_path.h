// SPDX-License-Identifier: GPL-3.0-or-later
// Which instructions a kernel with several bodies may use on this machine. The build itself stays
// at x86-64-v2; a kernel asks once and calls the body for the answer.
#pragma once

#include <string_view>

namespace patina {

enum class SimdPath { kBaseline, kAvx2, kAvx512 };  // kAvx512: F, BW, VL and VNNI

// The best that this processor has; $PATINA_SIMD = baseline | avx2 | avx512 asks for less. Read
// once. Throws ProcessingError(kConfig) for another word, kUnavailable for more than there is.
SimdPath simdPath();

// The rule behind it, for tests: `asked` may be empty.
SimdPath chooseSimdPath(std::string_view asked, SimdPath best);

}  // namespace patina
