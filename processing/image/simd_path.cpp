// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/image/simd_path.h"

#include <array>
#include <cstdlib>
#include <string>

#include "processing/image/failure.h"

namespace patina {
namespace {

constexpr std::array<std::string_view, 3> kNames{"baseline", "avx2", "avx512"};

SimdPath bestPath() {
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512vnni"))
    return SimdPath::kAvx512;
  return __builtin_cpu_supports("avx2") ? SimdPath::kAvx2 : SimdPath::kBaseline;
}

}  // namespace

SimdPath chooseSimdPath(std::string_view asked, SimdPath best) {
  if (asked.empty()) return best;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (asked != kNames[i]) continue;
    if (static_cast<SimdPath>(i) > best)
      throw ProcessingError(Exit::kUnavailable, "PATINA_SIMD asks for " + std::string(asked) +
                                                    "; this processor has no more than " +
                                                    std::string(kNames[static_cast<int>(best)]));
    return static_cast<SimdPath>(i);
  }
  throw ProcessingError(Exit::kConfig, "PATINA_SIMD is '" + std::string(asked) +
                                           "'; allowed: baseline, avx2, avx512");
}

SimdPath simdPath() {
  static const SimdPath path = [] {
    const char* asked = std::getenv("PATINA_SIMD");
    return chooseSimdPath(asked ? asked : "", bestPath());
  }();
  return path;
}

}  // namespace patina
