// SPDX-License-Identifier: GPL-3.0-or-later
#include "processing/patch/patch_distance.h"

#include <gtest/gtest.h>

#include <climits>
#include <vector>

#include "processing/image/random.h"

namespace patina::patch {
namespace {

std::vector<SimdPath> pathsHere() {
  std::vector<SimdPath> paths;
  for (const SimdPath path : {SimdPath::kBaseline, SimdPath::kAvx2, SimdPath::kAvx512})
    if (path <= simdPath()) paths.push_back(path);
  return paths;
}

TEST(PatchDistance, IsTheSumOfSquaresOnEveryPath) {
  constexpr std::ptrdiff_t kStride = 16 * 9;
  std::vector<std::int16_t> a, b;
  for (std::uint64_t i = 0; i < 9 * kStride; ++i) {
    a.push_back(
        static_cast<std::int16_t>(static_cast<int>(uniformBelow(hashSeed(i, 1), 800)) - 400));
    b.push_back(
        static_cast<std::int16_t>(static_cast<int>(uniformBelow(hashSeed(i, 2), 800)) - 400));
  }
  for (const int patch : {3, 5, 7})
    for (const int components : {4, 8, 16}) {
      std::int64_t exact = 0;
      for (int y = 0; y < patch; ++y)
        for (int i = 0; i < patch * components; ++i) {
          const std::int64_t d = a[y * kStride + i] - b[y * kStride + i];
          exact += d * d;
        }
      for (const SimdPath path : pathsHere()) {
        const PatchDistance distance = patchDistance(patch, components, path);
        EXPECT_EQ(distance(a.data(), b.data(), kStride, kStride, INT_MAX), exact)
            << patch << " " << components << " " << static_cast<int>(path);
        const std::int32_t stopped = distance(a.data(), b.data(), kStride, kStride, 10);
        EXPECT_GE(stopped, 10);
        EXPECT_LE(stopped, exact);
      }
    }
}

}  // namespace
}  // namespace patina::patch
